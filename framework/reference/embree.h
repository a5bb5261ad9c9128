// Embree 3 and 4 behind one face. Private to framework/reference; included only where Embree is there.
#pragma once
#if KESTREL_HAS_EMBREE >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace kestrel::embree {

#if KESTREL_HAS_EMBREE >= 4

using Context = RTCRayQueryContext;

inline void initContext(Context& context) { rtcInitRayQueryContext(&context); }

inline void intersect1(RTCScene scene, Context& context, RTCRayHit& ray) {
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.context = &context;
    rtcIntersect1(scene, &ray, &arguments);
}

inline void intersect16(RTCScene scene, Context& context, const int* valid, RTCRayHit16& rays,
                        bool coherent) {
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.context = &context;
    if (coherent) arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
    rtcIntersect16(valid, scene, &rays, &arguments);
}

inline void occluded1(RTCScene scene, Context& context, RTCRay& ray) {
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.context = &context;
    rtcOccluded1(scene, &ray, &arguments);
}

inline void occluded16(RTCScene scene, Context& context, const int* valid, RTCRay16& rays) {
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.context = &context;
    rtcOccluded16(valid, scene, &rays, &arguments);
}

#else

using Context = RTCIntersectContext;

inline void initContext(Context& context) { rtcInitIntersectContext(&context); }

inline void intersect1(RTCScene scene, Context& context, RTCRayHit& ray) {
    rtcIntersect1(scene, &context, &ray);
}

inline void intersect16(RTCScene scene, Context& context, const int* valid, RTCRayHit16& rays,
                        bool coherent) {
    context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    rtcIntersect16(valid, scene, &context, &rays);
}

inline void occluded1(RTCScene scene, Context& context, RTCRay& ray) { rtcOccluded1(scene, &context, &ray); }

inline void occluded16(RTCScene scene, Context& context, const int* valid, RTCRay16& rays) {
    rtcOccluded16(valid, scene, &context, &rays);
}

#endif

} // namespace kestrel::embree
