"""Mass from mesh files against trimesh and numpy, on made meshes and on the links of public robots."""

import json
import re
import subprocess
import xml.etree.ElementTree as ElementTree
from functools import cache
from pathlib import Path
from urllib.parse import quote

import numpy
import pytest
import trimesh
from conftest import BINARY
from made_meshes import MADE, l_prism, star_prism
from models import public_models

WATER = 1000.0
# Double precision sums over the triangles of two programs, in different orders.
SAME = 1e-9
# The width of cracks that realnoid welds, as a part of the diagonal (docs/decisions/0011-mesh-files.md).
CRACK = 1e-6


def as_text_stl(mesh):
    return trimesh.exchange.stl.export_stl_ascii(mesh)


def as_obj(mesh):
    corners = [f"v {x!r} {y!r} {z!r}" for x, y, z in mesh.vertices.tolist()]
    return "\n".join(corners + [f"f {a} {b} {c}" for a, b, c in (mesh.faces + 1).tolist()])


WRITERS = {"binary.stl": lambda m: m.export(file_type="stl"), "text.stl": as_text_stl, "text.obj": as_obj}


def save(mesh, path):
    content = WRITERS[".".join(path.name.split(".")[-2:])](mesh)
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


# What realnoid says.


def urdf(links, folder):
    """A URDF with one link a line, in this order after the first; a link is (mesh file, attributes of mesh, of body)."""
    lines = ['<robot name="meshes"><link name="base"/>']
    for name, (mesh, of_mesh, of_body) in links.items():
        shape = f'<shape><mesh filename="{mesh}" {of_mesh}/></shape>'
        link = f'<link name="{name}"><realnoid><body specific_gravity="1" {of_body}>{shape}</body></realnoid></link>'
        lines.append(link + f'<joint name="to_{name}" type="fixed"><parent link="base"/><child link="{name}"/></joint>')
    path = folder / "robot.urdf"
    path.write_text("\n".join([*lines, "</robot>"]))
    return path


def inspect(path):
    done = subprocess.run([BINARY, "inspect", path, "--json"], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    return {link["name"]: link for link in json.loads(done.stdout)["links"]}


FINDING = re.compile(r"^(error|warning|note)\[([\w-]+)\]: (.*)\n *--> .*?:(\d+):\d+\n(?:.*\n)*?.*\^+ (link '[^']*'[^\n]*)", re.M)


def findings(path):
    """(severity, code, message, line, element) of each."""
    done = subprocess.run([BINARY, "check", path], capture_output=True, text=True, timeout=120)
    found = FINDING.findall(done.stdout)
    assert len(found) == sum(map(int, re.findall(r"(\d+) (?:error|warning|note)s?\b", done.stdout.splitlines()[-1])))
    return [(severity, code, message, int(line), element) for severity, code, message, line, element in found]


def tensor(link):
    i = link["inertia"]
    return numpy.array([[i["ixx"], i["ixy"], i["ixz"]], [i["ixy"], i["iyy"], i["iyz"]], [i["ixz"], i["iyz"], i["izz"]]])


def agree(link, mass, center, inertia, scale=(SAME, SAME, SAME)):
    """Within parts of the mass, of the largest length, and of the largest moment."""
    assert abs(link["mass"] - mass) <= scale[0] * abs(mass)
    reach = numpy.linalg.norm(center) + numpy.sqrt(abs(inertia).max() / mass)
    assert numpy.linalg.norm(numpy.array(link["center_of_mass"]) - center) <= scale[1] * reach
    assert abs(tensor(link) - inertia).max() <= scale[2] * abs(inertia).max()


def agrees_with_trimesh(link, mesh):
    mesh.density = WATER
    of = mesh.mass_properties
    agree(link, of["mass"], of["center_mass"], of["inertia"])


def skin(mesh, thickness):
    """Mass, centre of mass and inertia about it of a wall along the triangles, integrated by numpy."""
    corners = mesh.triangles - mesh.vertices.mean(axis=0)
    areas = numpy.linalg.norm(numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    weights = WATER * thickness * areas
    sums = corners.sum(axis=1)
    mass, center = weights.sum(), (weights[:, None] * sums / 3).sum(axis=0) / weights.sum()
    second = numpy.einsum("t,tki,tkj->ij", weights / 12, corners, corners) + numpy.einsum("t,ti,tj->ij", weights / 12, sums, sums)
    second -= mass * numpy.outer(center, center)
    return mass, center + mesh.vertices.mean(axis=0), numpy.trace(second) * numpy.eye(3) - second


@pytest.mark.parametrize("name", MADE)
@pytest.mark.parametrize("kind", WRITERS)
def test_made_meshes_weigh_what_trimesh_says(name, kind, tmp_path):
    path = save(MADE[name](), tmp_path / f"{name}.{kind}")
    robot = urdf({name: (path.name, "", "")}, tmp_path)
    assert findings(robot) == []
    read = trimesh.load_mesh(path, process=False)
    assert read.volume > 0
    agrees_with_trimesh(inspect(robot)[name], read)


def test_a_scaled_and_mirrored_mesh(tmp_path):
    """Scaling in the URDF is scaling by trimesh, which turns the triangles of a mirrored mesh as well."""
    path = save(l_prism(), tmp_path / "l.text.obj")
    link = inspect(urdf({"l": (path.name, 'scale="0.001 -0.002 0.0005"', "")}, tmp_path))["l"]
    mesh = trimesh.load_mesh(path, process=False)
    mesh.apply_transform(numpy.diag([0.001, -0.002, 0.0005, 1.0]))
    agrees_with_trimesh(link, mesh)


def test_a_mesh_that_is_inside_out_is_turned_and_told(tmp_path):
    mesh = star_prism()
    mesh.invert()
    path = save(mesh, tmp_path / "star.text.obj")
    robot = urdf({"star": (path.name, "", "")}, tmp_path)
    [(severity, code, message, line, element)] = findings(robot)
    assert (severity, code, line) == ("warning", "mesh-repaired", 2) and "inside out" in message and "'star'" in element
    agrees_with_trimesh(inspect(robot)["star"], star_prism())


@pytest.mark.parametrize("name", [*MADE, "open"])
def test_hollow_meshes_weigh_what_their_area_says(name, tmp_path):
    mesh = MADE[name]() if name in MADE else trimesh.creation.icosphere(subdivisions=2)
    if name == "open":
        mesh.update_faces(mesh.triangles_center[:, 2] > 0.1)
    path = save(mesh, tmp_path / f"{name}.text.obj")
    link = inspect(urdf({name: (path.name, "", 'dimension="2d" thickness="0.002"')}, tmp_path))[name]
    read = trimesh.load_mesh(path, process=False)
    assert abs(link["mass"] / (WATER * 0.002 * read.area) - 1) < SAME
    agree(link, *skin(read, 0.002))


# The links of public robots.


def collada(path):
    """The triangles of a COLLADA file as f64. pycollada, which trimesh reads it with, keeps f32."""
    tree = ElementTree.parse(path)
    space = {"c": "http://www.collada.org/2005/11/COLLADASchema"}
    by_id = {element.get("id"): element for element in tree.iter() if element.get("id")}
    target = lambda element, key: by_id[element.get(key).removeprefix("#")]
    unit = float(tree.find("c:asset/c:unit", space).get("meter"))
    parts = []
    for node in tree.iterfind(".//c:visual_scene/c:node", space):
        matrix = numpy.array(node.find("c:matrix", space).text.split(), dtype=float).reshape(4, 4)
        for instance in node.iterfind("c:instance_geometry", space):
            for triangles in target(instance, "url").iterfind("c:mesh/c:triangles", space):
                inputs = {i.get("semantic"): i for i in triangles.iterfind("c:input", space)}
                stride = 1 + max(int(i.get("offset")) for i in inputs.values())
                source = target(target(inputs["VERTEX"], "source").find("c:input", space), "source")
                vertices = numpy.array(source.find("c:float_array", space).text.split(), dtype=float).reshape(-1, 3)
                indices = numpy.array(triangles.find("c:p", space).text.split(), dtype=int)
                faces = indices[int(inputs["VERTEX"].get("offset")) :: stride].reshape(-1, 3)
                places = unit * (vertices @ matrix[:3, :3].T + matrix[:3, 3])
                parts.append(trimesh.Trimesh(places, faces, process=False))
    return trimesh.util.concatenate(parts)


def opinion(path):
    mesh = collada(path) if path.suffix == ".dae" else trimesh.load_mesh(path, process=False)
    mesh.merge_vertices(digits_vertex=15)
    return mesh


@cache
def links_of(robot):
    """Link name -> path of its visual mesh."""
    model = public_models()[robot]
    found = {}
    for link in ElementTree.parse(model).iter("link"):
        mesh = link.find("visual/geometry/mesh")
        if mesh is not None:
            package, inside = re.match(r"package://([^/]+)/(.*)", mesh.get("filename")).groups()
            [folder] = [f for f in model.parents if f.name == package]
            found[link.get("name")] = folder / inside
    return found


def odd_edges(faces):
    """The edges that do not have an even number of triangles."""
    faces = faces[(faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])]
    edges = numpy.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    unique, counts = numpy.unique(edges, axis=0, return_counts=True)
    return unique[counts % 2 == 1]


def is_closed(mesh):
    """After welding, at open edges, vertices that are nearer than a crack's width. trimesh's is_watertight also refuses
    edges where four triangles meet, as where two boxes touch along an edge; these enclose a volume all the same."""
    if mesh.is_watertight:
        return True
    border = numpy.unique(odd_edges(mesh.faces))
    places = mesh.vertices[border]
    onto = numpy.arange(len(mesh.vertices))
    for k, place in enumerate(places):
        near = numpy.linalg.norm(places[: k + 1] - place, axis=1) <= CRACK * numpy.linalg.norm(mesh.extents)
        onto[border[k]] = onto[border[numpy.argmax(near)]]
    return len(odd_edges(onto[mesh.faces])) == 0


ROBOTS = ["g1", "jvrc1"]


@pytest.fixture(scope="module", params=ROBOTS)
def robot(request, tmp_path_factory):
    """(mesh paths, findings of the URDF with all of them, folder)."""
    folder = tmp_path_factory.mktemp(request.param)
    links = {name: (path, "", "") for name, path in links_of(request.param).items()}
    return links_of(request.param), findings(urdf(links, folder)), folder


def test_just_the_open_link_meshes_are_refused(robot):
    """Each with its link and line."""
    paths, found, _ = robot
    errors = {element.split("'")[1]: (code, line) for severity, code, _, line, element in found if severity == "error"}
    lines = {name: i + 2 for i, name in enumerate(paths)}
    still_open = {name for name, path in paths.items() if not is_closed(opinion(path))}
    assert errors == {name: ("mesh-not-closed", lines[name]) for name in still_open}
    assert still_open and len(still_open) < len(paths) / 4, "the robots have both kinds"


def holds(mesh, point):
    """Does the closed mesh go around the point? By the solid angles of its triangles."""
    a, b, c = (mesh.triangles - point).transpose(1, 0, 2)
    la, lb, lc = (numpy.linalg.norm(v, axis=1) for v in (a, b, c))
    dot = lambda u, v: (u * v).sum(axis=1)
    angles = numpy.arctan2(dot(a, numpy.cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb)
    return abs(angles.sum()) > numpy.pi


def turned_parts(mesh):
    """The mesh with its parts that face inwards turned, unless they are cavities: wholly within a part that does not."""
    labels = numpy.arange(len(mesh.faces))
    while True:
        pairs = mesh.face_adjacency
        least = labels.copy()
        numpy.minimum.at(least, pairs[:, 0], labels[pairs[:, 1]])
        numpy.minimum.at(least, pairs[:, 1], labels[pairs[:, 0]])
        if (least == labels).all():
            break
        labels = least[least]
    parts = [mesh.submesh([labels == label], append=True) for label in numpy.unique(labels)]
    for part in [p for p in parts if p.volume < 0]:
        if not any(all(holds(other, v) for v in part.vertices) for other in parts if other.volume > abs(part.volume)):
            part.invert()
    return trimesh.util.concatenate(parts)


def test_link_meshes_weigh_what_trimesh_says(robot):
    paths, found, folder = robot
    told = {}
    for severity, code, message, _, element in found:
        told.setdefault(element.split("'")[1], []).append((severity, code, message))
    sound = {name: path for name, path in paths.items() if not any(s == "error" for s, _, _ in told.get(name, []))}
    assert {code for name in sound for _, code, _ in told.get(name, [])} <= {"mesh-repaired", "mesh-overlaps-itself"}
    links = inspect(urdf({name: (path, "", "") for name, path in sound.items()}, folder))
    untouched = 0
    for name, path in sound.items():
        mesh = opinion(path)
        sentences = " ".join(message for _, _, message in told.get(name, []))
        if "inside out" in sentences:
            mesh = turned_parts(mesh)
        if "cracks" in sentences:
            # No vertex moves by more than a crack's width w, so the volume changes by no more than the area × w, and
            # second moments, of masses within the diagonal, by no more than that × the diagonal².
            moved = WATER * mesh.area * CRACK * numpy.linalg.norm(mesh.extents)
            of = mesh.mass_properties
            assert abs(links[name]["mass"] - WATER * of["volume"]) <= moved
            assert abs(tensor(links[name]) - WATER * of["inertia"]).max() <= 2 * moved * numpy.linalg.norm(mesh.extents) ** 2
        else:
            agrees_with_trimesh(links[name], mesh)
            untouched += 1
    assert untouched > len(paths) / 2


def test_hollow_link_meshes_weigh_what_their_area_says(robot):
    """The open ones as well."""
    paths, _, folder = robot
    hollow = 'dimension="2d" thickness="0.003"'
    path = urdf({name: (mesh, "", hollow) for name, mesh in paths.items()}, folder)
    assert findings(path) == []
    links = inspect(path)
    for name, file in paths.items():
        agree(links[name], *skin(opinion(file), 0.003))


def test_every_public_mesh_is_read(tmp_path):
    """Several hundred files of some forty robots: solids, repaired solids, or open for a reason that is told."""
    [folder] = {model.parents[3] for model in [public_models()["g1"]]}
    meshes = sorted(p for p in folder.rglob("*") if p.suffix.lower() in (".stl", ".obj", ".dae"))
    robot = urdf({f"l{i}": (path, "", "") for i, path in enumerate(meshes)}, tmp_path)
    found = findings(robot)
    assert {(severity, code) for severity, code, *_ in found} == {
        ("error", "mesh-not-closed"),
        ("warning", "mesh-repaired"),
        ("warning", "mesh-overlaps-itself"),
    }
    refused = {element for severity, _, _, _, element in found if severity == "error"}
    assert len(meshes) > 500 and len(refused) < len(meshes) / 2


def test_trimesh_reads_collada_as_we_do():
    """Unit and node matrices, to the f32 that pycollada keeps."""
    for path in set(links_of("jvrc1").values()):
        theirs = trimesh.load(path, process=False, skip_materials=True).to_mesh()
        ours = collada(path)
        assert len(theirs.faces) == len(ours.faces)
        assert numpy.allclose(theirs.bounds, ours.bounds, atol=1e-6)


def test_file_addresses_and_packages(tmp_path):
    """The same file under all its names; --package wins over the folder above."""
    (tmp_path / "robot one/meshes").mkdir(parents=True)
    path = save(l_prism(), tmp_path / "robot one/meshes/l.text.obj")
    names = ["meshes/l.text.obj", path, f"file://{quote(str(path))}", "package://robot one/meshes/l.text.obj"]
    links = inspect(urdf({f"l{i}": (name, "", "") for i, name in enumerate(names)}, tmp_path / "robot one"))
    for i in range(len(names)):
        agrees_with_trimesh(links[f"l{i}"], l_prism())
    (tmp_path / "other").mkdir()
    save(star_prism(), tmp_path / "other/l.text.obj")
    robot = urdf({"l": ("package://robot one/l.text.obj", "", "")}, tmp_path / "robot one")
    told = ["--package", f"robot one={tmp_path / 'other'}"]
    done = subprocess.run([BINARY, "inspect", robot, "--json", *told], capture_output=True, text=True, timeout=120)
    agrees_with_trimesh({l["name"]: l for l in json.loads(done.stdout)["links"]}["l"], star_prism())


def test_a_missing_package_is_told_with_link_and_line(tmp_path):
    robot = urdf({"a": ("package://nowhere/a.stl", "", "")}, tmp_path)
    [(severity, code, message, line, element)] = findings(robot)
    assert (severity, code, line) == ("error", "unknown-package", 2) and "'a'" in element
    assert "nowhere" in message and "ROS_PACKAGE_PATH" in message
