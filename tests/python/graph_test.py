"""The graph as a document in Python, and the table of pass types as attributes, docstrings and stubs."""
import ast
import copy
import json
import pickle
import subprocess
import sys
from pathlib import Path

import kestrel
from kestrel import passes
from kestrel_cli import RAY_AO, SOURCE, done, folder, run_tests
from python_support import refused


def test_a_graph_is_loaded_and_saved_byte_for_byte():
    graph = kestrel.load("ray_ao.json")
    assert list(graph) == ["gbuffer", "bom", "roma", "bvh", "ao", "mean"]
    assert graph == kestrel.load(RAY_AO) and len(graph) == 6
    assert ("roma.tracer", "ao.tracer") in graph.edges
    assert graph.outputs == ["mean.result"] and graph.scene == "builtin:tower"
    with folder() as place:
        graph.save(Path(place) / "again.json")
        assert (Path(place) / "again.json").read_text() == str(graph) == str(kestrel.Graph.parse(str(graph)))


def test_properties_are_attributes_with_the_tables_ranges():
    graph = kestrel.load("ray_ao.json")
    assert isinstance(graph.roma, passes.Roma) and graph.roma.angular == 4 and graph["bom"].method == "separating"
    graph.roma.angular = 8
    graph.ao.snap = False
    assert '"angular": 8' in str(graph) and graph.ao.properties()["snap"] is False
    del graph.ao.rays
    assert '"rays"' not in str(graph) and graph.ao.rays == passes.TABLE["RayAmbientOcclusion"]["properties"][0]["default"]
    before = str(graph)
    for change, said in [(lambda: setattr(graph.bom, "resolution", -1), "must be"),
                         (lambda: setattr(graph.bom, "resolution", 2.5), "must be"),
                         (lambda: setattr(graph.bom, "method", "three_axes"), "did you mean 'three_axis'?"),
                         (lambda: setattr(graph.bom, "resolution", 10 ** 30), "out of range"),
                         (lambda: setattr(graph.bom, "resolution", [1, "x"]), "must hold numbers, not str"),
                         (lambda: setattr(graph.roma, "offset", float("nan")), "must be"),
                         (lambda: setattr(graph.bom, "method", None), "must be a bool, a number, a text")]:
        assert said in str(refused(change)), said
    assert "did you mean 'resolution'?" in str(refused(lambda: setattr(graph.bom, "resolutoin", 64), AttributeError))
    assert str(graph) == before


def test_numpys_numbers_are_numbers():
    from python_support import need_numpy
    numpy = need_numpy()
    graph = kestrel.load("ray_ao.json")
    graph.bom.resolution = numpy.int32(64)
    graph.ao.snap = numpy.bool_(False)
    assert graph.bom.resolution == 64 and graph.ao.snap is False
    number = next((name, entry["name"]) for name, info in passes.TABLE.items() for entry in info["properties"]
                  if entry["kind"] == "float" and entry.get("minimum", 1) <= 0.5 <= entry.get("maximum", 0))
    made = kestrel.Graph().add(number[0], "made")
    setattr(made, number[1], numpy.float32(0.5))
    assert getattr(made, number[1]) == 0.5


def test_graphs_need_no_numpy():
    script = "import sys; sys.modules['numpy'] = None; import kestrel; graph = kestrel.load('ray_ao.json'); graph.bom.resolution = 64;" \
             "graph.add('Environment', 'sky', zenith=[1, 0.5, 0.1]); print(graph.sky.zenith); graph.validate()"
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
    assert (run.returncode, run.stdout, run.stderr) == (0, "(1.0, 0.5, 0.1)\n", ""), run


def test_a_graph_is_built_from_nothing():
    graph = kestrel.Graph()
    graph.name, graph.scene = "Depth", "builtin:tower"
    graph.add(passes.GBuffer, "first")
    graph.add("RayAmbientOcclusion", "ao", rays=2)
    graph.add(passes.Bvh, "bvh")
    graph.connect("bvh.tracer", "ao.tracer")
    graph.rename("first", "gbuffer")
    for port in ["depth", "normal", "face_normal"]:
        graph.connect(f"gbuffer.{port}", f"ao.{port}")
    graph.outputs = ["ao.visibility"]
    graph.validate()
    assert len(graph.edges) == 4 and graph.ao.rays == 2
    other = graph.copy()
    other.remove("bvh")
    other.disconnect("ao.depth")
    assert len(other.edges) == 2 and len(graph.edges) == 4 and other != graph
    assert "tracer" in str(refused(other.validate))
    before = str(graph)
    told = refused(lambda: graph.add(passes.Roma, "roma", angular=-1, rotation=7))
    assert len(told.problems) == 2, told
    for change in [lambda: graph.add("Rome", "x"), lambda: graph.connect("bvh.tracer", "ao.depth"),
                   lambda: graph.remove("b"), lambda: setattr(graph, "outputs", ["ao.visibility", "ao.nothing"])]:
        refused(change)
    assert str(graph) == before


def test_settings_variables_and_mutes():
    graph = kestrel.Graph.parse('{"kestrel": 1, "variables": {"many": 3}, "passes": {'
                                '"ao": {"type": "RayAmbientOcclusion", "properties": {"rays": {"variable": "many"}}}}}')
    assert graph.set("many=5") is graph and graph.ao.rays == 5 and graph.variables == {"many": 5}
    graph.ao.rays = 6
    assert graph.variables == {"many": 6}
    graph.ao.muted = True
    assert graph.ao.muted and '"muted": true' in str(graph)
    assert "did you mean 'rays'?" in str(refused(lambda: graph.set("ao.ray=1")))


def test_every_problem_has_its_place():
    told = refused(lambda: kestrel.Graph.parse('{"kestrel": 1,\n  "pases": {},\n  "outputs": 3}', "my.json"))
    assert [problem.line for problem in told.problems if problem.file == "my.json"].count(2) == 1
    assert len(told.problems) >= 2 and str(told).splitlines() == [str(problem) for problem in told.problems]
    assert any(str(problem).startswith("my.json:2:") and "'passes'" in problem.message for problem in told.problems)
    assert isinstance(told, kestrel.Error) and isinstance(told, ValueError)
    assert pickle.loads(pickle.dumps(told)).problems == told.problems and copy.copy(told).problems == told.problems
    assert "did you mean 'ray_ao.json'?" in str(refused(lambda: kestrel.load("ray_a.json")))


def test_every_type_of_the_table_is_a_class():
    table = {info["name"]: info for info in json.loads(done("passes", "--json").out)["passes"]}
    assert passes.TABLE == table and len(table) > 40
    for name, info in table.items():
        kind = getattr(passes, name)
        assert issubclass(kind, kestrel.Pass) and kind.__doc__.startswith(info["description"])
        made = kestrel.Graph().add(kind, "made")
        for entry in info["properties"]:
            attribute = getattr(kind, entry["name"])
            assert entry["description"] in attribute.__doc__, (name, entry["name"])
            default = tuple(entry["default"]) if entry["kind"] == "vector" else entry["default"]
            assert getattr(made, entry["name"]) == default, (name, entry["name"])
            if entry["kind"] in ("int", "float"):
                for bound, beyond in (("minimum", -1), ("maximum", 1)):
                    if entry.get(bound) is not None:
                        setattr(made, entry["name"], entry[bound])
                        refused(lambda: setattr(made, entry["name"], entry[bound] + beyond * (1 + abs(entry[bound]))))


def test_the_stubs_are_those_of_the_table():
    stub = Path(kestrel.__file__).parent / "passes.pyi"
    classes = {node.name: node for node in ast.parse(stub.read_text()).body if isinstance(node, ast.ClassDef)}
    assert sorted(classes) == passes.__all__
    for name, node in classes.items():
        kind = getattr(passes, name)
        told = {item.target.id: ast.unparse(item.annotation) for item in node.body if isinstance(item, ast.AnnAssign)}
        assert told == {key: ast.unparse(ast.parse(text)) for key, text in kind.__annotations__.items()}, name
        assert ast.get_docstring(node).split() == kind.__doc__.split(), name
        docs = [item.value.value for item in node.body[1:] if isinstance(item, ast.Expr)]
        assert [doc.split() for doc in docs] == [getattr(kind, key).__doc__.split() for key in told], name


def test_the_package_holds_what_the_tree_has():
    place = Path(kestrel.__file__).parent
    for file in (SOURCE / "apps" / "python" / "kestrel").glob("*.py"):
        assert (place / file.name).read_text() == file.read_text()
    assert (place / "py.typed").exists() and kestrel.__version__ in done("--version").out


if __name__ == "__main__":
    run_tests(globals())
