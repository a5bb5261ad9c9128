# Compiler flags. Every target of Kestrel links kestrel_options; nothing sets flags elsewhere.
add_library(kestrel_options INTERFACE)
target_compile_options(kestrel_options INTERFACE
    -Wall -Wextra -Wpedantic $<$<COMPILE_LANGUAGE:CXX>:-Wnon-virtual-dtor> $<$<COMPILE_LANGUAGE:CXX>:-Woverloaded-virtual> -Werror
    # The CPU oracles must round as the shaders do: no fused multiply-add behind our back.
    -ffp-contract=off)

# GCC 12 sees overlapping copies in std::string where there are none (GCC bug 105651).
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(kestrel_options INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Wno-restrict>)
endif()

# Two files in one group: a local name that hides the other file's is no mistake, and a class with members of
# unnamed-namespace types is still seen by its own file alone.
if(KESTREL_UNITY)
    target_compile_options(kestrel_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:$<$<COMPILE_LANGUAGE:CXX>:-Wno-subobject-linkage>>)
    # GCC collects its garbage before there is much: 3 (graph) to 9 (scene) per cent of what a group of files takes.
    target_compile_options(kestrel_options INTERFACE
        "$<$<AND:$<CXX_COMPILER_ID:GNU>,$<COMPILE_LANGUAGE:CXX>>:SHELL:--param ggc-min-heapsize=500000>")
else()
    target_compile_options(kestrel_options INTERFACE -Wshadow)
endif()

if(KESTREL_CONFIG STREQUAL "release")
    # -O2 is for what loops over pixels, texels or triangles: compiling with -O1 takes 0.6 to 0.7 of the time. With less inlined,
    # GCC can't tell what is initialized: that is -O2's to say.
    set(loops $<BOOL:$<TARGET_PROPERTY:KESTREL_LOOPS>>)
    target_compile_options(kestrel_options INTERFACE
        $<IF:${loops},-O2,-O1> $<$<AND:$<NOT:${loops}>,$<CXX_COMPILER_ID:GNU>>:-Wno-maybe-uninitialized>)
elseif(KESTREL_CONFIG STREQUAL "debug")
    target_compile_options(kestrel_options INTERFACE -O1 -g)
    target_compile_definitions(kestrel_options INTERFACE KESTREL_DEBUG=1)
elseif(KESTREL_CONFIG STREQUAL "sanitize")
    # Not optimized: GCC compiles what both sanitizers instrument three to four times as fast.
    target_compile_options(kestrel_options INTERFACE -O0 -g -fno-omit-frame-pointer
                           -fsanitize=address,undefined -fno-sanitize-recover=undefined)
    target_link_options(kestrel_options INTERFACE -fsanitize=address,undefined)
    target_compile_definitions(kestrel_options INTERFACE KESTREL_DEBUG=1 KESTREL_SANITIZE=1)
elseif(KESTREL_CONFIG STREQUAL "fuzz")
    if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
        message(FATAL_ERROR "KESTREL_CONFIG fuzz needs clang: -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++")
    endif()
    target_compile_options(kestrel_options INTERFACE -O1 -gline-tables-only -fno-omit-frame-pointer
                           -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=undefined)
    target_link_options(kestrel_options INTERFACE -fsanitize=address,undefined)
else()
    message(FATAL_ERROR "KESTREL_CONFIG is '${KESTREL_CONFIG}'; it must be release, debug, sanitize or fuzz")
endif()

find_program(MOLD mold)
if(MOLD)
    target_link_options(kestrel_options INTERFACE -fuse-ld=mold)
endif()
