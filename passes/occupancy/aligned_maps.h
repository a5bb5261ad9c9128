// Arrays of ray-aligned occupancy maps: their layout, the step that rotates, and what is uploaded for it.
// Shared by the passes that make such arrays.
#pragma once
#include "candidates.h"
#include "graph/pass.h"

namespace kestrel {

class Commands;

// How the rotated maps are made, with the same bits: `Automatic` from the occupied cells alone where these
// are few.
enum class RotationMethod : std::uint8_t { Automatic, Gather };

struct AlignedMaps {
    int resolution = 0, directions = 0;
    int levels = 1; // base maps one after the other in a buffer, and the arrays made of them likewise
    Desc desc;      // of the rotated maps
    [[nodiscard]] int words() const { return resolution / 32; }
    // The defines RESOLUTION, WORDS and DIRECTIONS of the shaders.
    [[nodiscard]] Defines defines() const;
    // Of the buffer `directions`.
    [[nodiscard]] Desc directionsDesc() const;
    [[nodiscard]] Desc rotationsDesc() const;
};

// angular^2 maps a level. A problem at port "tracer" if they do not fit into one storage block.
AlignedMaps alignedMaps(int resolution, int angular, int levels, const Capabilities& capabilities,
                        Declaration& declaration);

// Rotates "occupancy" (of this description) by "rotations" into "maps". `inTurn`: those of a Renewal.
Step rotateStep(const AlignedMaps& maps, const Desc& occupancy, bool inTurn,
                const Capabilities& capabilities);

// Instead of rotateStep(): lists the occupied cells of a level's base map in "cells", and where they are few
// makes its maps from them alone (shaders/occupancy/scatter.comp). In this order; `blank` is needed where
// "maps" was not cleared before. What they run, after the level was set, is up to the pass:
struct ScatterSteps {
    Step list, choose, blank, scatter, rotate;
};
ScatterSteps scatterSteps(const AlignedMaps& maps, const Desc& occupancy, bool inTurn,
                          const Capabilities& capabilities);
// Of "cells": room for as many of each level as make scattering faster than visiting every cell.
Desc occupiedCellsDesc(const AlignedMaps& maps);
// In the step before `list`.
void clearOccupiedCells(int resolution, int level, Commands& commands);
// In `list`: needed only where the base map has changed.
void listOccupiedCells(int resolution, Commands& commands);
// In `choose`: only where the list or the number of maps to make has changed.
void chooseRotation(const Renewal& renewal, Commands& commands);
// In the others. `renewal`: in turn, else null.
enum class RotationPart { Blank, Scatter, Rotate };
void dispatchChosen(RotationPart part, const AlignedMaps& maps, int level, const Renewal* renewal,
                    Commands& commands);

// In the step that rotateStep() made: all maps, or those of the renewal in turn.
void dispatchRotation(const AlignedMaps& maps, const Renewal& renewal, bool inTurn, Commands& commands);

// Fills "directions" and, where the step writes it, "rotations".
void uploadCandidates(const Candidates& candidates, float offset, float skip, Commands& commands);

// The uses and defines by which a module reads "maps" and "directions".
void addMapUses(const AlignedMaps& maps, const Capabilities& capabilities, Module& tracer);

} // namespace kestrel
