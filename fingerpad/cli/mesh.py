"""``fingerpad mesh``: the finger's mesh as a file for gmsh."""

from collections.abc import Sequence

from fingerpad.cli.arguments import PICTURE, Kind, Parser, echo, scene_of
from fingerpad.scene.messages import SceneError

_MESH = Kind("a mesh", (".msh",), "$MeshFormat\n2.2 ")
_EXAMPLES = """
    fingerpad mesh --out finger.msh --plot finger.png
    fingerpad mesh scene.toml --set mesh.contact=20e-6 --out coarse.msh
"""


def main(argv: Sequence[str]) -> int:
    """Write a mesh; return the exit code."""
    parser = Parser("mesh", _EXAMPLES)
    parser.add_scene()
    parser.add_file("--out", _MESH, "file for gmsh (default: finger.msh)", "finger.msh")
    parser.add_file("--plot", PICTURE, "picture of the mesh")
    args = parser.read(argv)
    scene = scene_of(args)
    if scene.geometry.file is not None:
        raise SceneError("geometry.file is given, which is a mesh already; fingerpad check draws it")
    from fingerpad.cli import section

    found = section.write(scene, args.out)
    echo(f"{len(found.triangles)} triangles, {len(found.points)} vertices, {found.ridges} ridges that can touch")
    echo(f"Written: {args.out}")
    if args.plot:
        section.draw(args.plot, found, scene)
        echo(f"Written: {args.plot}")
    return 0
