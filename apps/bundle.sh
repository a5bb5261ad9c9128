#!/usr/bin/env bash
# Makes kestrel-VERSION-x86_64.tar.xz of what is built (or builds it): programs, plugins, shaders, graphs, and every library
# but the C library and the GL driver, which stay those of the machine that it is unpacked on.
#   apps/bundle.sh [FOLDER]      where the archive is put; default: the build
# It runs wherever the C library is as new as here. What a machine's GL driver may load too (C++, compression, X11) lies in
# lib/fallback: the program that is started takes of each the newer one, the machine's or this.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
build=${KESTREL_BUILD:-$root/build}
"$root/apps/install.sh" bundle
# What the demo built is not all.
[ -x "$build/bin/kestrel" ] && grep -q '^KESTREL_PASSES:STRING=$' "$build/CMakeCache.txt" || "$root/apps/build.sh"
folder=$(realpath "${1:-$build}")
name=kestrel-$("$build/bin/kestrel" --version | awk 'NR == 1 { print $2 }')-$(uname -m)
temporary=$(mktemp -d)
trap 'rm -rf "$temporary"' EXIT
bundle=$temporary/$name
cmake --install "$build" --prefix "$bundle" --strip >/dev/null
rm -rf "$bundle/include" "$bundle/lib/cmake" "$bundle"/lib/python* # a Python module is for one interpreter

host='^(ld-linux.*|linux-vdso|libc|libm|libdl|libpthread|librt|libmvec|libresolv|libutil|libanl|libnsl|libE?GL.*|libGLdispatch|libOpenGL|libOSMesa)\.so'
either='^(libstdc\+\+|libgcc_s|libz|libzstd|liblzma|libexpat|libffi|libbsd|libmd|libdrm.*|libX.*|libxcb.*)\.so'
programs=("$bundle"/bin/*)
ldd "${programs[@]}" "$bundle"/lib/libkestrel.so "$bundle"/lib/kestrel/*.so | awk '$2 == "=>" && $3 ~ /^\// { print $1, $3 }' | sort -u |
    while read -r library file; do
        [[ $library =~ $host || $file == "$bundle"* ]] && continue
        target=$bundle/lib
        [[ $library =~ $either ]] && target=$bundle/lib/fallback/$(basename "$(readlink -f "$file")")
        mkdir -p "$target" "$bundle/licences"
        cp -L "$file" "$target/$library"
        package=$(dpkg-query -S "$file" "$(readlink -f "$file")" "/usr$file" 2>/dev/null | sed -n '1s/:.*//p' || true)
        [ -z "$package" ] || cp -L "/usr/share/doc/$package/copyright" "$bundle/licences/$package"
    done
cp "$root/LICENSE" "$bundle/licences/kestrel"
find "$bundle/lib" -maxdepth 1 -type f -exec patchelf --set-rpath '$ORIGIN' {} +
find "$bundle/lib/kestrel" -name '*.so' -exec patchelf --set-rpath '$ORIGIN/..' {} +
for program in "${programs[@]}"; do
    patchelf --set-rpath '$ORIGIN/../lib' "$program"
    cp "$root/apps/bundle_start.sh" "$bundle/$(basename "$program")"
done
tar -C "$temporary" -cJf "$folder/$name.tar.xz" "$name"
du -h "$folder/$name.tar.xz"
