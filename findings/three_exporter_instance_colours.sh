#!/usr/bin/env bash
# three.js 0.187.0, GLTFExporter: an InstancedMesh that shows fewer instances than it has room for is exported with
# attributes of different lengths.
#
# InstancedMesh.count is the usual way to show a part of an instanced mesh. The exporter writes TRANSLATION, ROTATION and
# SCALE of EXT_mesh_gpu_instancing for `count` instances, but the accessor of the colours (_COLOR_0) whole. The extension
# requires one count for all attributes of a node. glTF Validator 2.0.0-dev.3.10 finds no error, since it does not know the
# extension; glTF Transform's command line 4.5.1 copies the file as it is. A reader that takes the number of instances from whichever attribute
# comes last, or refuses the file, is the one that shows it.
set -euo pipefail
work=$(mktemp -d) && trap 'rm -rf "$work"' EXIT && cd "$work"
npm init -y >/dev/null && npm install --silent --no-audit --no-fund three@0.187.0 gltf-validator@2.0.0-dev.3.10 >/dev/null
cat >export.mjs <<'JS'
import * as THREE from 'three';
import { GLTFExporter } from 'three/addons/exporters/GLTFExporter.js';
import validator from 'gltf-validator';
// The exporter's one need of a browser.
globalThis.FileReader = class {
    readAsDataURL(blob) {
        blob.arrayBuffer().then((bytes) => {
            this.result = 'data:application/octet-stream;base64,' + Buffer.from(bytes).toString('base64');
            this.onloadend();
        });
    }
};
const mesh = new THREE.InstancedMesh(new THREE.BoxGeometry(), new THREE.MeshStandardMaterial(), 3);
for (let i = 0; i < 3; ++i) {
    mesh.setMatrixAt(i, new THREE.Matrix4().makeTranslation(2 * i, 0, 0));
    mesh.setColorAt(i, new THREE.Color(i / 2, 0, 0));
}
mesh.count = 2;
const gltf = await new GLTFExporter().parseAsync(new THREE.Scene().add(mesh), { binary: false });
const { attributes } = gltf.nodes.find((node) => node.extensions).extensions.EXT_mesh_gpu_instancing;
for (const [name, accessor] of Object.entries(attributes)) console.log(name, gltf.accessors[accessor].count);
const report = await validator.validateBytes(new TextEncoder().encode(JSON.stringify(gltf)));
console.log('errors of the validator:', report.issues.numErrors);
JS
node export.mjs >seen 2>/dev/null
cat seen
diff seen - <<'OUT'
TRANSLATION 2
ROTATION 2
SCALE 2
_COLOR_0 3
errors of the validator: 0
OUT
