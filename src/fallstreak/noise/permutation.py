"""Ken Perlin's permutation (2002), how lanes read a table in memory, and what a seed does to such kinds.

There is one permutation for all seeds, so that a seed moves the lattice: by 0 to 255 cells along each axis,
and by none for the first octave of seed 0, which is Perlin's own.
"""

from __future__ import annotations

from llvmlite import ir
from numba.core import cgutils
from numba.core.registry import cpu_target

from .hashing import axis_words
from .lattice import inlined, neighbour
from .static import StaticType, Table
from .vectors import FLOAT, I32, INT, Lanes, call, constant, features, intrinsic

# fmt: off
PERLINS = (
    151, 160, 137, 91, 90, 15, 131, 13, 201, 95, 96, 53, 194, 233, 7, 225, 140, 36, 103, 30, 69, 142, 8,
    99, 37, 240, 21, 10, 23, 190, 6, 148, 247, 120, 234, 75, 0, 26, 197, 62, 94, 252, 219, 203, 117, 35,
    11, 32, 57, 177, 33, 88, 237, 149, 56, 87, 174, 20, 125, 136, 171, 168, 68, 175, 74, 165, 71, 134,
    139, 48, 27, 166, 77, 146, 158, 231, 83, 111, 229, 122, 60, 211, 133, 230, 220, 105, 92, 41, 55, 46,
    245, 40, 244, 102, 143, 54, 65, 25, 63, 161, 1, 216, 80, 73, 209, 76, 132, 187, 208, 89, 18, 169,
    200, 196, 135, 130, 116, 188, 159, 86, 164, 100, 109, 198, 173, 186, 3, 64, 52, 217, 226, 250, 124,
    123, 5, 202, 38, 147, 118, 126, 255, 82, 85, 212, 207, 206, 59, 227, 47, 16, 58, 17, 182, 189, 28,
    42, 223, 183, 170, 213, 119, 248, 152, 2, 44, 154, 163, 70, 221, 153, 101, 155, 167, 43, 172, 9,
    129, 22, 39, 253, 19, 98, 108, 110, 79, 113, 224, 232, 178, 185, 112, 104, 218, 246, 97, 228, 251,
    34, 242, 193, 238, 210, 144, 12, 191, 179, 162, 241, 81, 51, 145, 235, 249, 14, 239, 107, 49, 192,
    214, 31, 181, 199, 106, 157, 184, 84, 204, 176, 115, 121, 50, 45, 127, 4, 150, 254, 138, 236, 205,
    93, 222, 114, 67, 29, 24, 72, 243, 141, 128, 195, 78, 66, 215, 61, 156, 180,
)
# fmt: on

PERMUTATION = Table(PERLINS, integer=True)
ORIGIN = axis_words(0, 0)


@intrinsic
def gather(typingctx, table, index):
    """Entries of a table in memory; the index must be within it."""
    if not isinstance(table, StaticType) or not isinstance(index, Lanes) or index.element != INT:
        return None
    width, integer = index.width, table.value.integer
    element = I32 if integer else ir.FloatType()

    def codegen(context, builder, sig, args):
        values = ir.Constant(ir.ArrayType(element, len(table.value.values)), list(table.value.values))
        memory = cgutils.global_constant(builder.module, "noise.table", values)
        base = builder.bitcast(memory, ir.IntType(8).as_pointer())
        if width == 1:
            return _entry(builder, memory, args[1], element)
        vector = ir.VectorType(element, width)
        nothing, all_lanes = ir.Constant(vector, ir.Undefined), ir.VectorType(ir.IntType(1), width)
        have = features(cpu_target.target_context)
        if width == 16 and "avx512f" in have:
            name = f"llvm.x86.avx512.mask.gather.dp{'i' if integer else 's'}.512"
            every = ir.Constant(all_lanes, [1] * 16)
            return call(builder, name, vector, [nothing, base, args[1], every, I32(4)])
        if width == 8 and "avx2" in have:
            name = f"llvm.x86.avx2.gather.d.{'d' if integer else 'ps'}.256"
            every = builder.bitcast(constant(index, -1), vector)
            return call(builder, name, vector, [nothing, base, args[1], every, ir.IntType(8)(4)])
        found = nothing
        for lane in range(width):
            number = builder.extract_element(args[1], I32(lane))
            found = builder.insert_element(found, _entry(builder, memory, number, element), I32(lane))
        return found

    return index.of(INT if integer else FLOAT)(table, index), codegen


def _entry(builder, memory, number, element):
    # without a sign: LLVM else extends it, which costs an instruction
    place = builder.gep(memory, [I32(0), builder.zext(number, ir.IntType(64))], inbounds=True)
    return builder.load(place, typ=element)


@inlined
def permuted(i):
    """The permutation of a number's low eight bits."""
    return gather(PERMUTATION, i & 255)


@inlined
def lattice_pair(cell, word, origin, period):
    """A cell's own index along one axis and the next, wrapped by the period and moved by the seed."""
    moved = (word ^ origin) & 255
    return cell + moved, neighbour(cell, 1, period) + moved
