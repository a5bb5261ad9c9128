// Which primitives each pixel of the A-buffer's views sees, and between which depths: what ABuffer traces
// with `record: primitive` (Vardis, Vasilakis, Papaioannou, "DIRT: Deferred Image-based Ray Tracing", HPG
// 2016). A pixel has a record of every triangle that touches its square
// (shaders/abuffer/primitive_cover.glsl): there is no conservative rasterization on every driver, so
// triangles are covered in compute.
#pragma once
#include "graph/registry.h"

namespace kestrel {

// Records of a pixel at most: each is ordered by a loop over those of its bucket.
inline constexpr int longestRecordList = 50'000;

// The internal ports of the records: the table of a pass that declares them has these.
template<class T>
Describe<T>& addPrimitiveRecords(Describe<T>& table) {
    return table.internal("cells", PortKind::Buffer, "Each pixel's depth bounds and where its records begin")
        .internal("records", PortKind::Buffer, "Primitives by pixel, bucket and depth")
        .internal("candidates", PortKind::Buffer, "The same in the order in which they are found")
        .internal("order", PortKind::Buffer, "Candidates by pixel and bucket")
        .internal("candidate_count", PortKind::Buffer, "Candidates in all")
        .internal("record_count", PortKind::Buffer, "Records in all")
        .internal("longest_list", PortKind::Buffer, "Records of the pixel that has most")
        .internal("record_runs", PortKind::Buffer, "Records before each run of pixels")
        .internal("blocks", PortKind::Buffer, "Blocks of pixels that large triangles touch")
        .internal("tiles", PortKind::Buffer, "Tiles of those");
}

// Declares the records of the views and buckets of `lists`: the buffers, and the steps that make them, in the
// group "records". What a module reads of them, `cells` first.
std::vector<Use> declarePrimitiveRecords(Declaration& declaration, const World& world,
                                         const FragmentLists& lists, const Demand& demand);

} // namespace kestrel
