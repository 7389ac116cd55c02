"""The words of WGSL itself: keywords, and the names declared before any module is read.

A name that is neither declared, imported nor listed here is a mistake, found before the driver's compiler
sees it. The lists follow the WGSL specification (keyword summary and "Predeclared" sections) plus the
extensions naga knows, because a missing word here would be a false alarm.
"""

from __future__ import annotations

_KEYWORDS = """alias break case const const_assert continue continuing default diagnostic discard else enable
    false fn for if let loop override requires return struct switch true var while"""
KEYWORDS = frozenset(_KEYWORDS.split())

# What WESL adds to them.
WESL_KEYWORDS = frozenset(["as", "import", "package", "super", "self"])

# Attributes whose arguments are words of the attribute, not expressions that name declarations.
WORD_ATTRIBUTES = frozenset(["builtin", "interpolate", "diagnostic", "early_depth_test"])

_SCALARS = "bool f16 f32 f64 i32 u32 i64 u64"
_VECTORS = " ".join(f"vec{n}{t}" for n in "234" for t in ("", "f", "h", "i", "u"))
_MATRICES = " ".join(f"mat{c}x{r}{t}" for c in "234" for r in "234" for t in ("", "f", "h"))
_TYPES = """array atomic ptr sampler sampler_comparison binding_array
    texture_1d texture_2d texture_2d_array texture_3d texture_cube texture_cube_array texture_multisampled_2d
    texture_storage_1d texture_storage_2d texture_storage_2d_array texture_storage_3d
    texture_depth_2d texture_depth_2d_array texture_depth_cube texture_depth_cube_array
    texture_depth_multisampled_2d texture_external
    acceleration_structure ray_query RayDesc RayIntersection vertex_return"""
_ENUMERANTS = """read write read_write atomic function private workgroup uniform storage push_constant
    immediate handle task_payload
    r8unorm r8snorm r8uint r8sint r16unorm r16snorm r16uint r16sint r16float rg8unorm rg8snorm rg8uint rg8sint
    r32uint r32sint r32float rg16unorm rg16snorm rg16uint rg16sint rg16float rgba8unorm rgba8snorm rgba8uint
    rgba8sint bgra8unorm rgb10a2uint rgb10a2unorm rg11b10float rg11b10ufloat r64uint rg32uint rg32sint
    rg32float rgba16unorm rgba16snorm rgba16uint rgba16sint rgba16float rgba32uint rgba32sint rgba32float"""
_FUNCTIONS = """bitcast all any select arrayLength
    abs acos acosh asin asinh atan atanh atan2 ceil clamp cos cosh countLeadingZeros countOneBits
    countTrailingZeros cross degrees determinant distance dot dot4U8Packed dot4I8Packed exp exp2 extractBits
    faceForward firstLeadingBit firstTrailingBit floor fma fract frexp insertBits inverseSqrt ldexp length log
    log2 max min mix modf normalize outer pow quantizeToF16 radians reflect refract reverseBits round saturate
    sign sin sinh smoothstep sqrt step tan tanh transpose trunc inverse
    dpdx dpdxCoarse dpdxFine dpdy dpdyCoarse dpdyFine fwidth fwidthCoarse fwidthFine
    textureDimensions textureGather textureGatherCompare textureLoad textureNumLayers textureNumLevels
    textureNumSamples textureSample textureSampleBias textureSampleCompare textureSampleCompareLevel
    textureSampleGrad textureSampleLevel textureSampleBaseClampToEdge textureStore
    textureAtomicMin textureAtomicMax textureAtomicAdd textureAtomicAnd textureAtomicOr textureAtomicXor
    atomicLoad atomicStore atomicAdd atomicSub atomicMax atomicMin atomicAnd atomicOr atomicXor
    atomicExchange atomicCompareExchangeWeak
    pack4x8snorm pack4x8unorm pack4xI8 pack4xU8 pack4xI8Clamp pack4xU8Clamp pack2x16snorm pack2x16unorm
    pack2x16float unpack4x8snorm unpack4x8unorm unpack4xI8 unpack4xU8 unpack2x16snorm unpack2x16unorm
    unpack2x16float
    storageBarrier textureBarrier workgroupBarrier workgroupUniformLoad subgroupBarrier
    subgroupAdd subgroupExclusiveAdd subgroupInclusiveAdd subgroupAll subgroupAnd subgroupAny subgroupBallot
    subgroupBroadcast subgroupBroadcastFirst subgroupElect subgroupMax subgroupMin subgroupMul
    subgroupExclusiveMul subgroupInclusiveMul subgroupOr subgroupShuffle subgroupShuffleDown
    subgroupShuffleUp subgroupShuffleXor subgroupXor
    quadBroadcast quadSwapDiagonal quadSwapX quadSwapY
    rayQueryInitialize rayQueryProceed rayQueryGenerateIntersection rayQueryConfirmIntersection
    rayQueryTerminate rayQueryGetCommittedIntersection rayQueryGetCandidateIntersection"""

PREDECLARED = frozenset(f"{_SCALARS} {_VECTORS} {_MATRICES} {_TYPES} {_ENUMERANTS} {_FUNCTIONS}".split())
