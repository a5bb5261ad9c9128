// What a plugin's source includes: the macro that makes a shared library a plugin of Kestrel.
//
//     #include "plugin/plugin.h"
//     KESTREL_PLUGIN { registry.add(describeMyPass()); }
//
// It exports two C functions. The loader compares the stamps first: a plugin that was built against other
// headers, by another compiler, or with flags that change layouts, is refused before anything of it runs.
#pragma once
#include "graph/registry.h"
#include "kestrel_stamp.h" // generated: version and hash of the framework's headers
#include <cstdint>
#include <initializer_list>
#include <string>

namespace kestrel::detail {

consteval std::uint64_t mixSizes(std::initializer_list<std::uint64_t> sizes) {
    std::uint64_t hash = 14695981039346656037ULL; // FNV-1a
    for (const std::uint64_t size : sizes) hash = (hash ^ size) * 1099511628211ULL;
    return hash;
}
template<class... Types>
consteval std::uint64_t sizesOf() {
    return mixSizes({(std::uint64_t{sizeof(Types)} * 256 + alignof(Types))...});
}

// Sizes of what crosses the border: catches flags that change layouts (debug containers, packing).
inline constexpr std::uint64_t interfaceSizes =
    sizesOf<Pass, Declaration, Output, Step, Module, Use, ModuleUse, Desc, World, Inputs, Demand, PassType,
            PropertyInfo, PortInfo, Registry, Value, std::string, std::vector<int>>();

} // namespace kestrel::detail

#define KESTREL_TEXT_OF(x) #x
#define KESTREL_TEXT(x) KESTREL_TEXT_OF(x)
#if defined(__SANITIZE_ADDRESS__)
#define KESTREL_STAMP_FLAGS "address-sanitizer"
#else
#define KESTREL_STAMP_FLAGS "plain"
#endif

// The stamp as an expression of type std::string. Each library that uses it gets its own text.
#define KESTREL_ABI_STAMP                                                                                    \
    (std::string("kestrel " KESTREL_STAMP_VERSION ", headers " KESTREL_STAMP_HEADERS                         \
                 ", compiler " __VERSION__ ", C++ " KESTREL_TEXT(__cplusplus) ", " KESTREL_STAMP_FLAGS       \
                                                                              ", sizes ") +                  \
     std::to_string(std::integral_constant<std::uint64_t, ::kestrel::detail::interfaceSizes>::value))

#define KESTREL_PLUGIN                                                                                       \
    static void kestrelRegisterTypes(::kestrel::Registry& registry);                                         \
    extern "C" __attribute__((visibility("default"))) const char* kestrelPluginStamp() {                     \
        static const std::string stamp = KESTREL_ABI_STAMP;                                                  \
        return stamp.c_str();                                                                                \
    }                                                                                                        \
    extern "C" __attribute__((visibility("default"))) void kestrelPluginRegister(                            \
        ::kestrel::Registry* registry) {                                                                     \
        kestrelRegisterTypes(*registry);                                                                     \
    }                                                                                                        \
    static void kestrelRegisterTypes(::kestrel::Registry& registry)
