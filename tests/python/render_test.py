"""Rendering from Python: the command line's pictures, errors, metrics, progress, the interpreter's lock."""
import json
import os
import resource
import signal
import subprocess
import sys
import threading
import time

import kestrel
from kestrel_cli import SMALL, done, folder, kestrel as run_kestrel, need, run_tests
from python_support import SCENE, SIZE, need_numpy, refused


def renderer(graph="ray_ao.json", **options):
    return kestrel.Renderer(graph, SCENE, size=SIZE, **options)


def test_outputs_are_the_command_lines_to_the_bit():
    numpy = need_numpy()
    with folder() as place:
        done("render", "ray_ao.json", *SMALL, "--frames", 3, "--seed", 5, "--set", "roma.angular=2",
             "--output", f"mean.result={place}/a.exr", "--output", f"gbuffer.normal={place}/n.exr")
        graph = kestrel.load("ray_ao.json")
        graph.roma.angular = 2
        ours = renderer(graph, seed=5)
        outputs = ours.render(frames=3)
        assert list(outputs) == ["mean.result"]
        picture = outputs["mean.result"]
        assert picture.dtype == numpy.float32 and picture.shape == (36, 64) and picture.flags.writeable
        assert numpy.array_equal(picture, kestrel.read_image(f"{place}/a.exr")) and 0.1 < picture.mean() < 1
        normal = ours.read("gbuffer.normal")
        assert normal.shape[:2] == (36, 64) and numpy.array_equal(normal[..., :3], kestrel.read_image(f"{place}/n.exr")[..., :3])


def test_an_array_owns_its_memory():
    numpy = need_numpy()
    ours = renderer()
    first = ours.render()["mean.result"]
    kept = first.copy()
    second = ours.render(frames=2)["mean.result"]
    del ours
    assert numpy.array_equal(first, kept) and not numpy.array_equal(first, second)
    assert first.base is not None and not numpy.shares_memory(first, second)


def test_buffers_and_layers():
    numpy = need_numpy()
    ours = renderer(previews=["bom.occupancy"])
    ours.frame()
    words = ours["bom.occupancy"].view(numpy.uint32)
    assert words.any() and words.size > 1000
    assert "there is no" in str(refused(lambda: ours.read("bom.nothing"))) or "nothing" in str(refused(lambda: ours["bom.nothing"]))
    assert "no layer 3" in str(refused(lambda: ours.read("mean.result", layer=3)))
    assert "no level 9" in str(refused(lambda: ours.read("mean.result", mip=9)))
    assert "pass.port" in str(refused(lambda: ours.read("mean")))


def test_a_changed_graph_acts_with_the_next_frame():
    numpy = need_numpy()
    graph = kestrel.load("ray_ao.json")
    ours = renderer(graph)
    by_roma = ours.render()["mean.result"]
    assert any(item["what"] == "bvh" and item["why"] for item in ours.left_out)
    graph.connect("bvh.tracer", "ao.tracer")
    graph.outputs = ["mean.result", "gbuffer.depth"]
    outputs = ours.render()
    assert list(outputs) == ["mean.result", "gbuffer.depth"] and not numpy.array_equal(outputs["mean.result"], by_roma)
    assert {item["what"] for item in ours.left_out} >= {"roma", "bom"}
    graph.disconnect("ao.depth")
    assert "ao" in str(refused(ours.frame))
    graph.connect("gbuffer.depth", "ao.depth")
    assert "mean.result" in ours.render()
    fresh = kestrel.Renderer(graph, SCENE, size=SIZE).render()["mean.result"]
    ours.restart()
    assert numpy.array_equal(ours.render()["mean.result"], fresh)


def test_an_array_is_an_input_picture():
    numpy = need_numpy()
    random = numpy.random.default_rng(2)
    graph = kestrel.Graph()
    graph.scene = SCENE
    for channels in [1, 2, 3, 4]:
        given = random.normal(size=(7, 9, channels)).astype(numpy.float32)
        graph.show("mine", given)
        graph.outputs = ["mine.image"]
        ours = kestrel.Renderer(graph, size=(9, 7)) if channels == 1 else ours
        got = ours.render()["mine.image"].reshape(7, 9, -1)
        assert numpy.array_equal(got[..., :channels], given), channels
        assert channels != 3 or (got[..., 3] == 1).all()
    before = str(graph)
    refused(lambda: graph.show("mine", given, guard=-1))
    refused(lambda: graph.show("other", given[0, 0]))
    assert str(graph) == before
    # A depth of one's own feeds what is made of depths.
    occlusion = kestrel.load("ray_ao.json")
    ours = kestrel.Renderer(occlusion, SCENE, size=SIZE, previews=["gbuffer.depth"])
    expected = ours.render()["mean.result"]
    occlusion.show("captured", ours["gbuffer.depth"])
    occlusion.connect("captured.image", "ao.depth")
    ours.restart()
    assert numpy.array_equal(ours.render()["mean.result"], expected)
    occlusion.show("captured", numpy.zeros((36, 64), numpy.float32))
    ours.restart()
    assert not numpy.array_equal(ours.render()["mean.result"], expected)


def test_size_camera_lights_and_time():
    numpy = need_numpy()
    ours = renderer("direct_light.json", camera={"eye": [4, 3, 6], "target": [0, 1, 0], "fov": 50})
    before = ours.render()
    ours.set_size((32, 18))
    name = next(iter(before))
    assert ours.render()[name].shape[:2] == (18, 32) and before[name].shape[:2] == (36, 64)
    lit = renderer("direct_light.json", camera="eye=4,3,6 target=0,1,0 fov=50",
                   lights=[{"kind": "directional", "direction": [0, -1, 0], "intensity": 3}]).render()
    assert lit[name][..., :3].mean() > before[name][..., :3].mean()
    told = refused(lambda: renderer(camera={"eyes": [1, 2, 3]}, lights=["dircetional"]))
    assert len(told.problems) >= 2 and "did you mean" in str(told)
    told = refused(lambda: kestrel.Renderer("ray_ao.json", SCENE, size="640x360", seed=-1, fps=0, time="x", previews=["ao"]))
    assert len(told.problems) == 5, told
    assert "0 to 1000000" in str(refused(lambda: ours.set_time(float("nan"))))
    assert "1 to 16384" in str(refused(lambda: kestrel.Renderer("ray_ao.json", SCENE, size=(0, 5))))
    assert "tower" in str(refused(lambda: kestrel.Renderer("ray_ao.json", "builtin:towr")))


def test_plan_and_stats_are_data():
    need_numpy()
    ours = renderer(timing=True)
    frame = ours.frame()
    ours.frame()
    assert frame["index"] == 0 and frame["ms"] > 0 and {step["pass"] for step in frame["steps"]} >= {"gbuffer", "ao"}
    plan = json.loads(done("check", "ray_ao.json", *SMALL, "--gl", "--json").out)
    assert {key: ours.plan[key] for key in ours.plan} == {key: plan[key] for key in ours.plan}
    stats = ours.stats()
    assert stats["frames"] == 2 and stats["size"] == list(SIZE) and stats["left_out"] == ours.left_out


def test_metrics_are_the_command_lines():
    numpy = need_numpy()
    random = numpy.random.default_rng(1)
    a = (random.random((20, 30, 3)) * 255).astype(numpy.uint8)
    b = numpy.clip(a.astype(int) + random.integers(-20, 20, a.shape), 0, 255).astype(numpy.uint8)
    with folder() as place:
        for name, picture in (("a", a), ("b", b)):
            kestrel.write_image(f"{place}/{name}.png", picture, display=True)
            assert numpy.array_equal(numpy.rint(kestrel.read_image(f"{place}/{name}.png") * 255), picture)
        told = done("compare", f"{place}/a.png", f"{place}/b.png", "--json").json()
    ours = kestrel.compare(a, b)
    assert ours == told and 0 < ours["flip"]["mean"] < 1
    errors = kestrel.flip(a, b)
    assert errors.shape == (20, 30) and abs(errors.mean() - ours["flip"]["mean"]) < 1e-6
    assert kestrel.heat_map(errors).shape == (20, 30, 3) and kestrel.compare(a, a)["psnr"] is None
    mask = numpy.zeros((20, 30), bool)
    mask[:5, :7] = True
    expected = ((a[:5, :7].astype(float) - b[:5, :7]) ** 2).mean() / 255 ** 2
    assert abs(kestrel.compare(a, b, mask=mask)["mse"] / expected - 1) < 1e-5
    assert "size" in str(refused(lambda: kestrel.compare(a, b[:10])))
    assert "shape" in str(refused(lambda: kestrel.compare(a, b[0, 0])))
    assert "int64" in str(refused(lambda: kestrel.compare(a, b.astype(numpy.int64))))
    assert "finite" in str(refused(lambda: kestrel.compare(a, numpy.full(a.shape, numpy.nan))))
    assert "at most 1000" in str(refused(lambda: kestrel.flip(a, b, pixels_per_degree=0)))
    transposed = numpy.asfortranarray(a[::-1])
    assert abs(kestrel.compare(transposed, b[::-1])["mse"] / ours["mse"] - 1) < 1e-5
    assert abs(kestrel.to_srgb(numpy.full((2, 2), 0.2140411, numpy.float32)) - 0.5).max() < 1e-4


def test_other_threads_run_while_a_frame_renders():
    need_numpy()
    ours = kestrel.Renderer("reference_ao.json", SCENE, size=(160, 90)) if "embree" in kestrel.parts else renderer()
    if "embree" in kestrel.parts:
        ours.graph.reference.samples = 64
    times, stop = [], threading.Event()

    def tick():
        while not stop.is_set():
            times.append(time.perf_counter())
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    begin = time.perf_counter()
    ours.frame()
    end = time.perf_counter()
    stop.set()
    thread.join()
    assert sum(begin < when < end for when in times) >= 3, (end - begin, len(times))


def test_any_thread_may_render():
    numpy = need_numpy()
    results = {}

    def work(name):
        results[name] = renderer().render(frames=2)["mean.result"]

    threads = [threading.Thread(target=work, args=(name,)) for name in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    expected = renderer().render(frames=2)["mean.result"]
    assert len(results) == 3 and all(numpy.array_equal(picture, expected) for picture in results.values())


def test_progress_is_told_and_may_raise():
    need_numpy()
    need("embree" in kestrel.parts, "this build has no embree")
    told = []
    ours = kestrel.Renderer("reference_ao.json", SCENE, size=SIZE, progress=lambda fraction, what: told.append((fraction, what)))
    ours.frame()
    assert told and all(0 <= fraction <= 1 and isinstance(what, str) for fraction, what in told)

    def fail(fraction, what):
        raise KeyError("enough")

    assert "enough" in str(refused(kestrel.Renderer("reference_ao.json", SCENE, size=SIZE, progress=fail).frame, KeyError))
    again = []

    def nested(fraction, what):
        again.append(str(refused(ours.frame)))

    kestrel.Renderer("reference_ao.json", SCENE, size=SIZE, progress=nested).frame()
    refused(lambda: renderer(progress=3), TypeError)
    assert again and all("progress function" in text for text in again)


def test_an_interrupt_waits_for_the_frame_and_nothing_is_lost():
    numpy = need_numpy()
    ours = renderer()
    expected = ours.render(frames=3)["mean.result"]
    threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
    refused(lambda: ours.render(frames=1_000_000), KeyboardInterrupt)
    ours.restart()
    assert numpy.array_equal(ours.render(frames=3)["mean.result"], expected)


def test_renderers_give_their_memory_back():
    need_numpy()

    def peak_after(many):
        """Bytes that the process held at most so far, and what one renderer's plan asks for."""
        for _ in range(many):
            ours = kestrel.Renderer("ray_ao.json", SCENE, size=(512, 512))
            ours.frame()
        memory = ours.plan["memory"]
        return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, memory["transient"] + memory["persistent"]

    first, one = peak_after(3)
    last, _ = peak_after(12)
    assert one > 10_000_000 and last - first < 4 * one, (first, last, one)


def test_a_process_ends_well_whatever_it_holds():
    need_numpy()
    script = (f"import kestrel, os, sys\nkept = kestrel.Renderer('ray_ao.json', {SCENE!r}, size={SIZE})\n"
              "kept.frame()\nchild = os.fork()\nif child == 0:\n"
              "    try:\n        kept.frame()\n    except kestrel.MachineError as told:\n        assert 'spawn' in str(told)\n"
              "        del kept\n        sys.exit(5)\n"
              "assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 5\nprint('end')\n")
    # Python warns of forks beside threads from 3.12 on.
    run = subprocess.run([sys.executable, "-W", "ignore::DeprecationWarning", "-c", script], capture_output=True, text=True,
                         timeout=100)
    assert (run.returncode, run.stdout, run.stderr) == (0, "end\n", ""), run


def test_a_machine_without_opengl_is_told():
    script = ("import kestrel\ngraph = kestrel.load('ray_ao.json')\ngraph.validate()\n"
              "try:\n    kestrel.Renderer(graph)\nexcept kestrel.MachineError as told:\n    print(len(told.problems))\n")
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=100,
                         env={**os.environ, "MESA_GL_VERSION_OVERRIDE": "3.3"})
    need("4.6" in run_kestrel("render", "ray_ao.json", env={"MESA_GL_VERSION_OVERRIDE": "3.3"}).err, "this driver is not Mesa")
    assert (run.returncode, run.stderr) == (0, "") and int(run.stdout) >= 1, run


if __name__ == "__main__":
    run_tests(globals())
