// Sorts the lists of the pixels by depth, fragments at one depth by their triangle, so that the result depends on no
// order of arrival, and sets the links, heads and tails that the structure has (section 3.3, reorder stage). An item
// is a pixel, or with COUNTER and buckets, whose boundaries were known to the store stage, a list of a pixel.
//
// Up to SHORT fragments are sorted by insertion while they are read. Up to MEDIUM are merged in place, from runs of one
// node on; those of SB, which has no links, are sorted by Shell's method. Longer lists, up to LONGEST, would take an
// invocation more iterations than every driver runs (lib/iterations.glsl): they are listed, and each doubling of the
// runs is a dispatch over that list (MERGE: the runs' width), and so is setting the links (LINK). What is longer stays
// as it is, and its length is told.
#include "lib/iterations.glsl"
#include "shared/work_list.h"
#include "abuffer/lists.glsl"

layout(local_size_x = 64) in;

#if defined(COUNTER) && defined(BUCKETED) && !defined(SHIFTED)
#define ITEM_IS_BUCKET
#endif

layout(r32ui) uniform uimageBuffer pixels;
layout(r32ui) uniform uimageBuffer nodes;
#if defined(DECOUPLED) && !defined(NO_TRIANGLES)
layout(r32ui) uniform readonly uimageBuffer data;
#endif
#ifndef COUNTER
layout(r32ui) uniform readonly uimageBuffer segments;
#endif
layout(std430) buffer Longest { uint longest; };
#ifndef SB
layout(std430) buffer LongLists {
    WorkListHeader header;
    uint items[];
} long_lists;
#endif

float depthOf(uint node) { return uintBitsToFloat(imageLoad(nodes, NODE_AT(node, 0)).r); }

uint triangleOf(uint node) {
#ifdef NO_TRIANGLES
    return 0u;
#elif defined(DECOUPLED)
#ifdef SB
    return imageLoad(data, int(imageLoad(nodes, NODE_AT(node, 1)).r) - 1).r;
#else
    return imageLoad(data, int(node) - 1).r;
#endif
#else
    return imageLoad(nodes, NODE_AT(node, TRIANGLE_WORD)).r;
#endif
}

bool before(float z, uint triangle, float otherZ, uint otherTriangle) {
    return z < otherZ || (z == otherZ && triangle < otherTriangle);
}

// ---- short lists

float shortZ[SHORT];
uint shortTriangle[SHORT];
uint shortNode[SHORT]; // SB: the link
#if defined(SB) && defined(PLANES)
uint shortSlopes[SHORT];
#endif
int shortCount = 0;

void insert(float z, uint triangle, uint node, uint slopes) {
    int at = shortCount++;
    while (at > 0 && before(z, triangle, shortZ[at - 1], shortTriangle[at - 1])) {
        ITERATION;
        shortZ[at] = shortZ[at - 1];
        shortTriangle[at] = shortTriangle[at - 1];
        shortNode[at] = shortNode[at - 1];
#if defined(SB) && defined(PLANES)
        shortSlopes[at] = shortSlopes[at - 1];
#endif
        --at;
    }
    shortZ[at] = z;
    shortTriangle[at] = triangle;
    shortNode[at] = node;
#if defined(SB) && defined(PLANES)
    shortSlopes[at] = slopes;
#endif
}

#ifdef PLANES
uint slopesOf(uint node) { return imageLoad(nodes, NODE_AT(node, PLANE_WORD)).r; }
#else
uint slopesOf(uint node) { return 0u; }
#endif

#ifdef SB

uint firstNode;
int nodeCount;

void setNode(uint node, float z, uint link, uint slopes) {
    imageStore(nodes, NODE_AT(node, 0), uvec4(floatBitsToUint(z)));
    imageStore(nodes, NODE_AT(node, 1), uvec4(link));
#ifdef PLANES
    imageStore(nodes, NODE_AT(node, PLANE_WORD), uvec4(slopes));
#endif
}

// One gap of Shell's method: the nodes that lie `gap` apart are in order then.
void sortGap(int gap) {
    for (int i = gap; i < nodeCount; ++i) {
        ITERATION;
        uint moved = firstNode + uint(i);
        float z = depthOf(moved);
        uint triangle = triangleOf(moved);
        uint link = imageLoad(nodes, NODE_AT(moved, 1)).r;
        uint slopes = slopesOf(moved);
        int at = i;
        while (at >= gap) {
            ITERATION;
            uint other = firstNode + uint(at - gap);
            float otherZ = depthOf(other);
            if (!before(z, triangle, otherZ, triangleOf(other))) break;
            uint to = firstNode + uint(at);
            imageStore(nodes, NODE_AT(to, 0), uvec4(floatBitsToUint(otherZ)));
            setNode(to, otherZ, imageLoad(nodes, NODE_AT(other, 1)).r, slopesOf(other));
            at -= gap;
        }
        setNode(firstNode + uint(at), z, link, slopes);
    }
}

void main() {
    int pixel = int(gl_GlobalInvocationID.y) * ROW + int(gl_GlobalInvocationID.x);
    if (pixel >= ITEMS) return;
    firstNode = imageLoad(segments, 2 * pixel).r;
    nodeCount = int(imageLoad(segments, 2 * pixel + 1).r - firstNode);
#ifdef PLANES
    float spread = 0.0;
    for (int i = 0; i < nodeCount; ++i) {
        ITERATION;
        spread = max(spread, abufferSpread(slopesOf(firstNode + uint(i))));
    }
    imageStore(pixels, pixel * PIXEL_WORDS + SPREAD_WORD, uvec4(floatBitsToUint(spread)));
#endif
    imageStore(pixels, pixel * PIXEL_WORDS, uvec4(firstNode));
    imageStore(pixels, pixel * PIXEL_WORDS + 1, uvec4(nodeCount));
    if (nodeCount > LONGEST) {
        atomicMax(longest, uint(nodeCount));
        nodeCount = 0;
    }
    if (nodeCount <= SHORT) {
        for (int i = 0; i < nodeCount; ++i) {
            ITERATION;
            uint node = firstNode + uint(i);
            insert(depthOf(node), triangleOf(node), imageLoad(nodes, NODE_AT(node, 1)).r, slopesOf(node));
        }
        for (int i = 0; i < nodeCount; ++i) {
            ITERATION;
#ifdef PLANES
            setNode(firstNode + uint(i), shortZ[i], shortNode[i], shortSlopes[i]);
#else
            setNode(firstNode + uint(i), shortZ[i], shortNode[i], 0u);
#endif
        }
        nodeCount = 0;
    }
    // Ciura's gaps.
    sortGap(701);
    sortGap(301);
    sortGap(132);
    sortGap(57);
    sortGap(23);
    sortGap(10);
    sortGap(4);
    sortGap(1);
    ITERATIONS_END;
}

#else

uint nextOf(uint node) { return imageLoad(nodes, NODE_AT(node, 1)).r; }
void setNext(uint node, uint next) { imageStore(nodes, NODE_AT(node, 1), uvec4(next)); }

// Merges neighbouring runs of `width` nodes in order to runs of twice that; the head of the list.
uint mergeRuns(uint list, uint width) {
    uint head = 0u;
    uint tail = 0u;
    uint left = list;
    while (left != 0u) {
        ITERATION;
        uint right = left;
        uint leftCount = 0u;
        while (leftCount < width && right != 0u) {
            ITERATION;
            ++leftCount;
            right = nextOf(right);
        }
        uint rightCount = width;
        float leftZ = depthOf(left);
        uint leftTriangle = triangleOf(left);
        float rightZ = right != 0u ? depthOf(right) : 0.0;
        uint rightTriangle = right != 0u ? triangleOf(right) : 0u;
        while (leftCount > 0u || (rightCount > 0u && right != 0u)) {
            ITERATION;
            bool takeRight = leftCount == 0u || (rightCount > 0u && right != 0u && before(rightZ, rightTriangle, leftZ, leftTriangle));
            uint taken = takeRight ? right : left;
            uint following = nextOf(taken);
            if (takeRight) {
                right = following;
                --rightCount;
                if (right != 0u) {
                    rightZ = depthOf(right);
                    rightTriangle = triangleOf(right);
                }
            } else {
                left = following;
                --leftCount;
                if (leftCount > 0u) {
                    leftZ = depthOf(left);
                    leftTriangle = triangleOf(left);
                }
            }
            if (tail == 0u) {
                head = taken;
            } else {
                setNext(tail, taken);
            }
            tail = taken;
        }
        left = right;
    }
    if (tail != 0u) setNext(tail, 0u);
    return head;
}

// ---- what comes out: links, heads and tails

int words; // of the pixel
vec2 range = vec2(0.0); // of its depths: known once they are sorted, where no bucket was chosen before
uint last = 0u;
uint lastBucket = 0u;
uint ownBucket = 0u; // with ITEM_IS_BUCKET
uint emitted = 0u;
uint itemCount = 0u; // with SHIFTED
float spread = 0.0; // with PLANES

// The bucket whose head holds the list that is not sorted yet.
uint headBucket() { return ownBucket; }

void beginItem(int item) {
#ifdef ITEM_IS_BUCKET
    ownBucket = uint(item % BUCKETS);
    words = item / BUCKETS * PIXEL_WORDS;
#else
    words = item * PIXEL_WORDS;
#endif
}

void setRange(float least, float most) {
#if defined(BUCKETED) && !defined(COUNTER)
    range = vec2(least, most);
    imageStore(pixels, words, uvec4(floatBitsToUint(least)));
    imageStore(pixels, words + 1, uvec4(floatBitsToUint(most)));
#endif
}

void finish() {
    if (last == 0u) return;
    setNext(last, 0u);
#ifdef PLANES
    imageAtomicMax(pixels, words + SPREAD_WORD, floatBitsToUint(spread));
#endif
#ifdef TWO_WAYS
    imageStore(pixels, words + TAIL_WORD(lastBucket), uvec4(last));
#endif
}

void emit(uint node, float z) {
#ifndef BUCKETED
    uint bucket = 0u;
#elif defined(ITEM_IS_BUCKET)
    uint bucket = ownBucket;
#elif defined(SHIFTED)
    uint bucket = abufferShiftedBucket(emitted++, itemCount, uint(BUCKETS));
#else
    uint bucket = abufferBucket(z, range.x, range.y, uint(BUCKETS));
#endif
    spread = max(spread, abufferSpread(slopesOf(node)));
    uint previous = last;
    if (last == 0u || bucket != lastBucket) {
        finish();
        imageStore(pixels, words + HEAD_WORD(bucket), uvec4(node));
        previous = 0u;
    } else {
        setNext(last, node);
    }
#ifdef TWO_WAYS
    imageStore(nodes, NODE_AT(node, 2), uvec4(previous));
#endif
    last = node;
    lastBucket = bucket;
}

// Sets what the links of a sorted list are.
void link(uint list) {
#if defined(BUCKETED) && !defined(ITEM_IS_BUCKET)
    itemCount = 0u;
    uint final = list;
    for (uint node = list; node != 0u; node = nextOf(node)) {
        ITERATION;
        ++itemCount;
        final = node;
    }
    setRange(depthOf(list), depthOf(final));
#endif
    for (uint node = list; node != 0u;) {
        ITERATION;
        uint following = nextOf(node);
        emit(node, depthOf(node));
        node = following;
    }
    finish();
}

#if defined(MERGE) || defined(LINK)

void main() {
    if (gl_GlobalInvocationID.x >= min(long_lists.header.count, uint(LIST_CAPACITY))) return;
    beginItem(int(long_lists.items[gl_GlobalInvocationID.x]));
    // The list is kept in the word of its head meanwhile.
    uint list = imageLoad(pixels, words + HEAD_WORD(headBucket())).r;
#ifdef MERGE
    imageStore(pixels, words + HEAD_WORD(headBucket()), uvec4(mergeRuns(list, uint(MERGE))));
#else
    imageStore(pixels, words + HEAD_WORD(headBucket()), uvec4(0u));
    link(list);
#endif
    ITERATIONS_END;
}

#else

void main() {
    int item = int(gl_GlobalInvocationID.y) * ROW + int(gl_GlobalInvocationID.x);
    if (item >= ITEMS) return;
    beginItem(item);
    // Reads the list, into the short one as long as that suffices; otherwise it is `list`, linked.
    uint list = 0u;
    int count = 0;
#ifdef COUNTER
    list = imageLoad(pixels, words + HEAD_WORD(headBucket())).r;
    for (uint node = list; node != 0u && count <= LONGEST; node = nextOf(node)) {
        ITERATION;
        if (count < SHORT) insert(depthOf(node), triangleOf(node), node, 0u);
        ++count;
    }
#else
    uint first = imageLoad(segments, 2 * item).r;
    count = int(imageLoad(segments, 2 * item + 1).r - first);
    bool fits = count <= SHORT;
    for (int i = 0; i < min(count, LONGEST + 1); ++i) {
        ITERATION;
        uint node = first + uint(i);
        if (fits) {
            insert(depthOf(node), triangleOf(node), node, 0u);
        } else {
            setNext(node, i + 1 < count ? node + 1u : 0u);
        }
    }
    list = count > 0 ? first : 0u;
#endif
    if (count <= SHORT) {
        itemCount = uint(count);
        if (count > 0) setRange(shortZ[0], shortZ[count - 1]);
        for (int i = 0; i < count; ++i) {
            ITERATION;
            emit(shortNode[i], shortZ[i]);
        }
        finish();
        list = 0u;
    }
    if (count > LONGEST) atomicMax(longest, uint(count));
    if (count > MEDIUM) {
        uint at = atomicAdd(long_lists.header.count, 1u);
        atomicMax(long_lists.header.groups.x, at / workListGroup + 1u);
        long_lists.header.groups.yz = uvec2(1u);
        if (at < uint(LIST_CAPACITY) && count <= LONGEST) {
            long_lists.items[at] = uint(item);
            imageStore(pixels, words + HEAD_WORD(headBucket()), uvec4(list));
        }
        list = 0u;
    }
    for (uint width = 1u; width < uint(MEDIUM) && list != 0u && width < uint(count); width *= 2u) {
        ITERATION;
        list = mergeRuns(list, width);
    }
    if (list != 0u) link(list);
    ITERATIONS_END;
}

#endif

#endif
