"""Renders quantities by Cycles, within Blender: blender -b --factory-startup -P cycles_render.py -- JOB.json

The job is a list of pictures (cycles.py writes it). Of each the light in linear Rec. 709, three floats a pixel, rows from the
top, goes to the file `out`. Coordinates in the job are glTF's: y is up, metres; candela, lux and radiance as in Kestrel.
"""
import json
import math
import sys
from pathlib import Path

import bpy
import numpy
from mathutils import Matrix, Vector


# The importer of Blender 3.4 is older than Debian's numpy.
numpy.bool = bool


def turned(p):
    """Blender's z is up."""
    return Vector((p[0], -p[2], p[1]))


def looking(eye, target, up):
    """A matrix whose -z looks from eye to target."""
    back = (eye - target).normalized()
    right = up.cross(back).normalized()
    columns = [right, back.cross(right), back, eye]
    return Matrix([[c[i] for c in columns] for i in range(3)] + [[0, 0, 0, 1]])


def add_camera(scene, camera):
    data = bpy.data.cameras.new("camera")
    data.sensor_fit = "VERTICAL"
    data.angle = math.radians(camera["fov"])
    data.clip_start = 1e-3
    data.clip_end = 1e4
    thing = bpy.data.objects.new("camera", data)
    thing.matrix_world = looking(turned(camera["eye"]), turned(camera["target"]), Vector((0, 0, 1)))
    scene.collection.objects.link(thing)
    scene.camera = thing


def add_light(scene, light):
    kind, intensity = light["kind"], light["intensity"]
    if kind == "sphere":
        # Blender's round lamp is a disk that turns to whom it shines on: a mesh is a sphere.
        bpy.ops.mesh.primitive_uv_sphere_add(segments=256, ring_count=128, radius=light["radius"], location=turned(light["position"]))
        thing = bpy.context.object
        thing.data.materials.append(material_of("lamp", intensity))
        thing.visible_camera = False
        return
    data = bpy.data.lights.new("light", {"point": "POINT", "spot": "SPOT", "directional": "SUN", "rectangle": "AREA"}[kind])
    if kind == "directional":
        data.energy = intensity  # irradiance
        data.angle = 0
    elif kind == "rectangle":
        data.shape = "RECTANGLE"
        data.size, data.size_y = light["width"], light["height"]
        data.energy = intensity * 4 * data.size * data.size_y  # what Cycles takes for the power of a rectangle
    else:
        data.energy = intensity * 4 * math.pi  # power: intensity over the whole sphere, of a spot too
        data.shadow_soft_size = 0
    if kind == "spot":
        data.spot_size = 2 * math.radians(light["outer"])
        data.spot_blend = 0
        undo_cosine(data, turned(light["direction"]).normalized())
    thing = bpy.data.objects.new("light", data)
    position = turned(light.get("position", (0, 0, 0)))
    ahead = turned(light["direction"]) if "direction" in light else Vector((0, 0, -1))
    up = Vector((0, 0, 1)) if abs(ahead.normalized().z) < 0.99 else Vector((0, 1, 0))
    thing.matrix_world = looking(position, position + ahead, up)
    scene.collection.objects.link(thing)


def undo_cosine(lamp, axis):
    """Cycles multiplies what a spot lamp sends out by the cosine to its axis."""
    lamp.use_nodes = True
    nodes, links = lamp.node_tree.nodes, lamp.node_tree.links
    emission = next(node for node in nodes if node.type == "EMISSION")
    geometry, cosine, inverse = nodes.new("ShaderNodeNewGeometry"), nodes.new("ShaderNodeVectorMath"), nodes.new("ShaderNodeMath")
    cosine.operation = "DOT_PRODUCT"
    cosine.inputs[1].default_value = axis
    inverse.operation = "DIVIDE"
    inverse.inputs[0].default_value = 1
    links.new(geometry.outputs["Incoming"], cosine.inputs[0])
    links.new(cosine.outputs["Value"], inverse.inputs[1])
    links.new(inverse.outputs[0], emission.inputs["Strength"])


def material_of(name, emission):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    shader, out = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeOutputMaterial")
    shader.inputs["Strength"].default_value = emission
    links.new(shader.outputs[0], out.inputs["Surface"])
    return material


def replace_shader(material, picture):
    """The importer's material with its colour and its normal, but one lobe alone."""
    if not material.use_nodes:
        return
    nodes, links = material.node_tree.nodes, material.node_tree.links
    out = next(node for node in nodes if node.type == "OUTPUT_MATERIAL")
    principled = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    if picture["quantity"] == "occlusion":
        made = nodes.new("ShaderNodeEmission")
        occlusion = nodes.new("ShaderNodeAmbientOcclusion")
        occlusion.samples = 8
        occlusion.inputs["Distance"].default_value = picture["distance"]
        links.new(occlusion.outputs["AO"], made.inputs["Strength"])
    else:
        mirror = picture["quantity"] == "glossy" and material.name.startswith("mirror")
        made = nodes.new("ShaderNodeBsdfGlossy" if mirror else "ShaderNodeBsdfDiffuse")
        # As in glTF, alpha is the square of a lobe's roughness.
        made.inputs["Roughness"].default_value = principled.inputs["Roughness"].default_value if mirror else 0
        if mirror:
            made.distribution = "GGX"
        for ours, theirs in (("Base Color", "Color"), ("Normal", "Normal")):
            source = principled.inputs[ours]
            if source.is_linked:
                links.new(source.links[0].from_socket, made.inputs[theirs])
            elif ours == "Base Color":
                made.inputs[theirs].default_value = source.default_value
    links.new(made.outputs[0], out.inputs["Surface"])


def lean_normals(thing):
    """Normals at the corners in place of a normal map of one colour: Cycles darkens mapped normals by a term of its own (Estevez,
    Lecocq and Stein, "A Microfacet-Based Shadowing Function to Solve the Bump Terminator Problem", 2019)."""
    mesh = thing.data
    material = mesh.materials[0]
    images = [node.image for node in material.node_tree.nodes if node.type == "TEX_IMAGE"]
    if not images:
        return
    code = Vector(2 * value - 1 for value in images[0].pixels[:3])
    mesh.calc_tangents()
    corners = [None] * len(mesh.loops)
    for polygon in mesh.polygons:
        for i in polygon.loop_indices:
            loop, normal = mesh.loops[i], polygon.normal
            across = loop.bitangent_sign * normal.cross(loop.tangent)
            corners[i] = (code.x * loop.tangent + code.y * across + code.z * normal).normalized()
    mesh.free_tangents()
    mesh.use_auto_smooth = True
    mesh.normals_split_custom_set(corners)
    for polygon in mesh.polygons:
        polygon.use_smooth = True
    material.node_tree.nodes.remove(next(node for node in material.node_tree.nodes if node.type == "NORMAL_MAP"))


def set_up(picture):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=picture["file"])
    scene = bpy.context.scene
    for thing in list(bpy.data.objects):
        if thing.type in ("LIGHT", "CAMERA"):
            bpy.data.objects.remove(thing)
    for thing in bpy.data.objects:
        if thing.type == "MESH" and picture.get("lean"):
            lean_normals(thing)
    for material in bpy.data.materials:
        replace_shader(material, picture)
    for thing in bpy.data.objects:
        if thing.type == "MESH":
            thing.cycles.shadow_terminator_geometry_offset = thing.cycles.shadow_terminator_offset = 0
    for light in picture.get("lights", []):
        add_light(scene, light)
    add_camera(scene, picture["camera"])
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    background = scene.world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (1, 1, 1, 1)
    background.inputs["Strength"].default_value = 1 if picture["quantity"] == "sky" else 0
    return scene


def configure(scene, picture):
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = picture["size"]
    scene.render.resolution_percentage = 100
    scene.render.threads_mode = "FIXED"
    scene.render.threads = 2
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples = picture["samples"]
    cycles.seed = 1
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.pixel_filter_type = "GAUSSIAN"  # a box would have the width of a pixel whatever is asked for
    cycles.filter_width = 0.01  # the middle of the pixel, as a G-buffer has it
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.light_sampling_threshold = 0
    cycles.blur_glossy = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    bounces = 1 if picture["quantity"] in ("bounce", "glossy") else 0
    cycles.max_bounces = bounces
    cycles.diffuse_bounces = bounces
    cycles.glossy_bounces = bounces if picture["quantity"] == "glossy" else 0
    cycles.transmission_bounces = cycles.volume_bounces = 0
    cycles.min_light_bounces = cycles.min_transparent_bounces = 0


PASSES = {
    "sky": ["DiffDir"], "occlusion": ["Emit"], "direct": ["DiffDir"], "bounce": ["DiffInd"], "glossy": ["GlossInd"]
}


def render(picture, folder):
    scene = set_up(picture)
    configure(scene, picture)
    layer = scene.view_layers[0]
    layer.use_pass_diffuse_direct = layer.use_pass_diffuse_indirect = True
    layer.use_pass_glossy_direct = layer.use_pass_glossy_indirect = layer.use_pass_emit = True
    scene.use_nodes = True
    nodes, links = scene.node_tree.nodes, scene.node_tree.links
    nodes.clear()
    layers, files = nodes.new("CompositorNodeRLayers"), nodes.new("CompositorNodeOutputFile")
    files.base_path = str(folder)
    files.format.file_format = "OPEN_EXR"
    files.format.color_depth = "32"
    files.file_slots.clear()
    names = PASSES[picture["quantity"]]
    for name in names:
        files.file_slots.new(name)
        links.new(layers.outputs[name], files.inputs[name])
    bpy.ops.render.render()
    width, height = picture["size"]
    total = numpy.zeros((height, width, 3), numpy.float32)
    for name in names:
        file = folder / f"{name}{scene.frame_current:04d}.exr"
        image = bpy.data.images.load(str(file))
        image.colorspace_settings.name = "Non-Color"
        pixels = numpy.empty(width * height * 4, numpy.float32)
        image.pixels.foreach_get(pixels)
        total += pixels.reshape(height, width, 4)[::-1, :, :3]
        file.unlink()
    total.tofile(picture["out"])


def main():
    job = Path(sys.argv[sys.argv.index("--") + 1])
    for picture in json.loads(job.read_text()):
        render(picture, job.parent)
        print("rendered", picture["name"], flush=True)


main()
