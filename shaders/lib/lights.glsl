// The scene's lights at the frame's time.
#include "shared/scene.h"

layout(std430) readonly buffer Lights {
    uint scene_light_count;
    LightRecord scene_lights[];
};
