#!/usr/bin/env bash
# three.js 0.187.0, GLTFExporter: what a camera frames is not what the exported camera frames.
#
# PerspectiveCamera.zoom and OrthographicCamera.zoom are dropped, and of an orthographic frustum that is not centred only
# `right` and `top` are kept, as half widths of a centred one. No warning is given. glTF has no zoom, but both could be said
# in it: a zoom by a smaller angle or size, an off-centre frustum by a moved node.
# Whoever compares a renderer with pictures from three.js through an exported file compares different views.
set -euo pipefail
work=$(mktemp -d) && trap 'rm -rf "$work"' EXIT && cd "$work"
npm init -y >/dev/null && npm install --silent --no-audit --no-fund three@0.187.0 >/dev/null
cat >export.mjs <<'JS'
import * as THREE from 'three';
import { GLTFExporter } from 'three/addons/exporters/GLTFExporter.js';
const scene = new THREE.Scene();
const near = new THREE.PerspectiveCamera(60, 2, 0.1, 100);
near.zoom = 2;
near.updateProjectionMatrix();
const beside = new THREE.OrthographicCamera(-1, 5, 2, -2, 0.5, 10);
scene.add(near, beside);
const { cameras } = await new GLTFExporter().parseAsync(scene, { binary: false });
// Element 5 of a projection is 1 / tan(half the vertical angle), times the zoom.
console.log('perspective: framed', (2 * Math.atan(1 / near.projectionMatrix.elements[5])).toFixed(4), 'exported', cameras[0].perspective.yfov.toFixed(4));
console.log('orthographic: framed width', beside.right - beside.left, 'exported', 2 * cameras[1].orthographic.xmag);
JS
node export.mjs >seen 2>/dev/null
cat seen
diff seen - <<'OUT'
perspective: framed 0.5621 exported 1.0472
orthographic: framed width 6 exported 10
OUT
