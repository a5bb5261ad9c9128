// Noise and random numbers of the built-in scenes: integer hashes, so that every machine makes the same
// scene.
#pragma once
#include <cstdint>
#include <glm/glm.hpp>

namespace kestrel::builtin {

// A sequence of random numbers that is a function of its seed alone (PCG hash of a counter).
class RandomSequence {
public:
    explicit RandomSequence(std::uint32_t seed)
        : seed_(seed) {}
    float unit();                         // [0, 1)
    float between(float low, float high); // [low, high)
    glm::vec3 onSphere();                 // unit vector, uniform
private:
    std::uint32_t seed_, counter_ = 0;
};

// Gradient noise (Perlin's, with hashed gradients): range about -1 to 1, features of size 1.
float gradientNoise(const glm::vec3& p);
// Sum of `octaves` of gradient noise, each of half the size and amplitude of the one before.
float fractalNoise(const glm::vec3& p, int octaves);

// Distances to the nearest and second nearest of randomly jittered lattice points (Worley's cellular noise).
struct Cellular {
    float nearest = 0, second = 0;
};
Cellular cellularNoise(const glm::vec3& p);

} // namespace kestrel::builtin
