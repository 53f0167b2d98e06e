/* What only a C compiler can say about Embree's headers: the layout of the structs, for tests/abi.rs to compare the
   generated bindings with, and the inline functions, which have no symbol in the library. */

#include <stddef.h>
#include <embree4/rtcore.h>

struct embree4_fact {
  const char* name;
  size_t value;
};

#define STRUCT(T) {#T " size", sizeof(struct T)}, {#T " align", _Alignof(struct T)}
#define FIELD(T, f) {#T "." #f, offsetof(struct T, f)}

#if defined(RTC_GEOMETRY_INSTANCE_ARRAY)
#  define INST_PRIM_ID(T) FIELD(T, instPrimID),
#else
#  define INST_PRIM_ID(T)
#endif

#define RAY(T) \
  STRUCT(T), FIELD(T, org_x), FIELD(T, org_y), FIELD(T, org_z), FIELD(T, tnear), FIELD(T, dir_x), FIELD(T, dir_y), \
  FIELD(T, dir_z), FIELD(T, time), FIELD(T, tfar), FIELD(T, mask), FIELD(T, id), FIELD(T, flags)

#define HIT(T) \
  INST_PRIM_ID(T) STRUCT(T), FIELD(T, Ng_x), FIELD(T, Ng_y), FIELD(T, Ng_z), FIELD(T, u), FIELD(T, v), \
  FIELD(T, primID), FIELD(T, geomID), FIELD(T, instID)

#define RAY_HIT(T) STRUCT(T), FIELD(T, ray), FIELD(T, hit)

static const struct embree4_fact facts[] = {
  RAY(RTCRay), RAY(RTCRay4), RAY(RTCRay8), RAY(RTCRay16),
  HIT(RTCHit), HIT(RTCHit4), HIT(RTCHit8), HIT(RTCHit16),
  RAY_HIT(RTCRayHit), RAY_HIT(RTCRayHit4), RAY_HIT(RTCRayHit8), RAY_HIT(RTCRayHit16),

  STRUCT(RTCBounds), FIELD(RTCBounds, lower_x), FIELD(RTCBounds, lower_y), FIELD(RTCBounds, lower_z),
  FIELD(RTCBounds, align0), FIELD(RTCBounds, upper_x), FIELD(RTCBounds, upper_y), FIELD(RTCBounds, upper_z),
  FIELD(RTCBounds, align1),

  STRUCT(RTCRayQueryContext), INST_PRIM_ID(RTCRayQueryContext) FIELD(RTCRayQueryContext, instID),
#if RTC_MAX_INSTANCE_LEVEL_COUNT > 1
  FIELD(RTCRayQueryContext, instStackSize),
#endif

  STRUCT(RTCIntersectArguments), FIELD(RTCIntersectArguments, flags), FIELD(RTCIntersectArguments, feature_mask),
  FIELD(RTCIntersectArguments, context), FIELD(RTCIntersectArguments, filter), FIELD(RTCIntersectArguments, intersect),

  STRUCT(RTCOccludedArguments), FIELD(RTCOccludedArguments, flags), FIELD(RTCOccludedArguments, feature_mask),
  FIELD(RTCOccludedArguments, context), FIELD(RTCOccludedArguments, filter), FIELD(RTCOccludedArguments, occluded),
#if RTC_MIN_WIDTH
  FIELD(RTCIntersectArguments, minWidthDistanceFactor), FIELD(RTCOccludedArguments, minWidthDistanceFactor),
#endif

  STRUCT(RTCFilterFunctionNArguments), FIELD(RTCFilterFunctionNArguments, valid),
  FIELD(RTCFilterFunctionNArguments, geometryUserPtr), FIELD(RTCFilterFunctionNArguments, context),
  FIELD(RTCFilterFunctionNArguments, ray), FIELD(RTCFilterFunctionNArguments, hit),
  FIELD(RTCFilterFunctionNArguments, N),

  STRUCT(RTCBoundsFunctionArguments), FIELD(RTCBoundsFunctionArguments, geometryUserPtr),
  FIELD(RTCBoundsFunctionArguments, primID), FIELD(RTCBoundsFunctionArguments, timeStep),
  FIELD(RTCBoundsFunctionArguments, bounds_o),

  STRUCT(RTCIntersectFunctionNArguments), FIELD(RTCIntersectFunctionNArguments, valid),
  FIELD(RTCIntersectFunctionNArguments, geometryUserPtr), FIELD(RTCIntersectFunctionNArguments, primID),
  FIELD(RTCIntersectFunctionNArguments, context), FIELD(RTCIntersectFunctionNArguments, rayhit),
  FIELD(RTCIntersectFunctionNArguments, N), FIELD(RTCIntersectFunctionNArguments, geomID),

  STRUCT(RTCOccludedFunctionNArguments), FIELD(RTCOccludedFunctionNArguments, valid),
  FIELD(RTCOccludedFunctionNArguments, geometryUserPtr), FIELD(RTCOccludedFunctionNArguments, primID),
  FIELD(RTCOccludedFunctionNArguments, context), FIELD(RTCOccludedFunctionNArguments, ray),
  FIELD(RTCOccludedFunctionNArguments, N), FIELD(RTCOccludedFunctionNArguments, geomID),

  {"RTC_VERSION", RTC_VERSION},
  {"RTC_MAX_INSTANCE_LEVEL_COUNT", RTC_MAX_INSTANCE_LEVEL_COUNT},
};

/* The table of facts and its length. */
const struct embree4_fact* embree4_facts(size_t* count)
{
  *count = sizeof(facts) / sizeof(facts[0]);
  return facts;
}

void embree4_init_intersect_arguments(struct RTCIntersectArguments* args) { rtcInitIntersectArguments(args); }
void embree4_init_occluded_arguments(struct RTCOccludedArguments* args) { rtcInitOccludedArguments(args); }
void embree4_init_ray_query_context(struct RTCRayQueryContext* context) { rtcInitRayQueryContext(context); }
