#!/usr/bin/env bash
# assimp 5.2.5 (Debian 12), export as glTF 2.0: a material with an opacity below 1 is written twice, as metallic-roughness and as
# KHR_materials_pbrSpecularGlossiness, and only the first gets the opacity. The extension's diffuseFactor keeps an alpha of 1, so that a
# viewer that knows the extension draws the pane opaque (alphaMode is BLEND all the same), and one that does not draws it as glass.
# Every material that has a specular colour gets the extension, also where the source knows nothing of glossiness, as a Wavefront OBJ's.
#
# What was seen (an OBJ whose material says "d 0.3"):
#     glass: BLEND, baseColorFactor alpha 0.3, diffuseFactor alpha 1
# So of a blended material the lower of the two opacities counts (framework/scene/gltf_specular.cpp), with a warning.
set -euo pipefail
work=$(mktemp -d) && trap 'rm -rf "$work"' EXIT && cd "$work"
version=5.2.5~ds0-1+b1
apt-get download -qq "assimp-utils=$version" "libassimp5=$version" libdraco7 libminizip1
for package in *.deb; do dpkg -x "$package" root; done
libraries=$(dirname "$(find root -name 'libassimp.so.5')")
cat >pane.mtl <<'M'
newmtl glass
Kd 0.2 0.4 0.6
Ks 0.5 0.5 0.5
Ns 90
d 0.3
M
cat >pane.obj <<'O'
mtllib pane.mtl
v 0 0 0
v 1 0 0
v 0 1 0
vn 0 0 1
usemtl glass
f 1//1 2//1 3//1
O
LD_LIBRARY_PATH="$PWD/$libraries" root/usr/bin/assimp export pane.obj pane.gltf -fgltf2 >log.txt
python3 - <<'P'
import json
material = next(m for m in json.load(open("pane.gltf"))["materials"] if m["name"] == "glass")
fallback = material["pbrMetallicRoughness"]["baseColorFactor"][3]
gloss = material["extensions"]["KHR_materials_pbrSpecularGlossiness"]["diffuseFactor"][3]
line = f"glass: {material['alphaMode']}, baseColorFactor alpha {fallback:.3g}, diffuseFactor alpha {gloss:.3g}"
print(line)
raise SystemExit(line != "glass: BLEND, baseColorFactor alpha 0.3, diffuseFactor alpha 1")
P
