// The frame: the same for all programs.
#include "shared/view.h"

layout(std140) uniform Frame { FrameData frame; };
