#!/usr/bin/env bash
# three.js 0.187.0, GLTFExporter: a material that shows its back faces (side: BackSide) is exported as one that shows its
# front faces.
#
# Rooms and sky domes are made so in three.js. glTF knows double-sided or front only, so the triangles would have to be
# turned over; the exporter writes neither `doubleSided` nor other indices, and warns of nothing. A renderer that culls as
# glTF says shows the outside of the dome and nothing from within.
set -euo pipefail
work=$(mktemp -d) && trap 'rm -rf "$work"' EXIT && cd "$work"
npm init -y >/dev/null && npm install --silent --no-audit --no-fund three@0.187.0 >/dev/null
cat >export.mjs <<'JS'
import * as THREE from 'three';
import { GLTFExporter } from 'three/addons/exporters/GLTFExporter.js';
globalThis.FileReader = class {
    readAsDataURL(blob) {
        blob.arrayBuffer().then((bytes) => {
            this.result = 'data:application/octet-stream;base64,' + Buffer.from(bytes).toString('base64');
            this.onloadend();
        });
    }
};
const texts = [];
for (const side of [THREE.FrontSide, THREE.BackSide, THREE.DoubleSide]) {
    const dome = new THREE.Mesh(new THREE.SphereGeometry(1, 8, 4), new THREE.MeshStandardMaterial({ side }));
    texts.push(JSON.stringify(await new GLTFExporter().parseAsync(new THREE.Scene().add(dome), { binary: false })));
}
console.log('back as front:', texts[1] === texts[0], ' both as front:', texts[2] === texts[0]);
JS
node export.mjs >seen 2>/dev/null
cat seen
diff seen - <<'OUT'
back as front: true  both as front: false
OUT
