//! A box in every format, and a folder to write it to.

use realnoid::math::Vec3;
use realnoid::shape::{MeshFault, Meshes, SearchPaths, TriMesh};
use std::path::Path;
use std::sync::Arc;
use tempfile::TempDir;

/// A folder with files, and the meshes of a robot in it.
pub struct Folder(pub TempDir);

impl Folder {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn with(name: &str, content: impl AsRef<[u8]>) -> Self {
        let folder = Self::new();
        folder.write(name, content);
        folder
    }

    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        let path = self.0.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, content).unwrap();
    }

    pub fn path(&self) -> &Path {
        self.0.path()
    }

    pub fn meshes(&self) -> Meshes {
        Meshes::with_paths(&self.path().join("robot.urdf"), &[], SearchPaths::default())
    }

    pub fn mesh(&self, name: &str) -> Result<Arc<TriMesh>, MeshFault> {
        self.meshes().mesh(name)
    }
}

pub fn read(name: &str, content: impl AsRef<[u8]>) -> Result<Arc<TriMesh>, MeshFault> {
    Folder::with(name, content).mesh(name)
}

/// The eight corners and twelve triangles of a box from the origin to `size`, facing outwards.
pub fn cuboid(size: [f64; 3]) -> TriMesh {
    let vertices = (0..8).map(|i| Vec3::from_fn(|axis, _| if i >> axis & 1 == 1 { size[axis] } else { 0.0 })).collect();
    let quads: [[u32; 4]; 6] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriMesh { vertices, triangles }
}

pub fn moved(mut mesh: TriMesh, by: [f64; 3]) -> TriMesh {
    mesh.vertices.iter_mut().for_each(|v| *v += Vec3::from(by));
    mesh
}

/// Several meshes in one.
pub fn together(meshes: &[TriMesh]) -> TriMesh {
    let mut all = TriMesh::default();
    for mesh in meshes {
        let first = all.vertices.len() as u32;
        all.vertices.extend(&mesh.vertices);
        all.triangles.extend(mesh.triangles.iter().map(|t| t.map(|i| i + first)));
    }
    all
}

pub fn inside_out(mut mesh: TriMesh) -> TriMesh {
    mesh.flip();
    mesh
}

pub fn volume(mesh: &TriMesh) -> f64 {
    let six = |t: &[u32; 3]| {
        let [a, b, c] = mesh.corners(*t);
        a.dot(&b.cross(&c))
    };
    mesh.triangles.iter().map(six).sum::<f64>() / 6.0
}

pub fn binary_stl(header: &[u8], mesh: &TriMesh) -> Vec<u8> {
    let mut bytes = header.to_vec();
    bytes.resize(80, b' ');
    bytes.extend((mesh.triangles.len() as u32).to_le_bytes());
    for triangle in &mesh.triangles {
        bytes.extend([0; 12]);
        let numbers = mesh.corners(*triangle).into_iter().flat_map(|c| [c.x, c.y, c.z]);
        numbers.for_each(|x| bytes.extend((x as f32).to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

pub fn ascii_stl(mesh: &TriMesh) -> String {
    let mut text = String::from("solid a box\n");
    for triangle in &mesh.triangles {
        text += "facet normal nan nan nan\n outer loop\n";
        mesh.corners(*triangle).iter().for_each(|c| text += &format!("  vertex {} {} {}\n", c.x, c.y, c.z));
        text += " endloop\nendfacet\n";
    }
    text + "endsolid a box\n"
}

pub fn obj(mesh: &TriMesh) -> String {
    let corners: String = mesh.vertices.iter().map(|v| format!("v {} {} {}\n", v.x, v.y, v.z)).collect();
    let face = |[a, b, c]: &[u32; 3]| format!("f {} {} {}\n", a + 1, b + 1, c + 1);
    corners + &mesh.triangles.iter().map(face).collect::<String>()
}

/// A COLLADA file: what stands in `<asset>`, in `<mesh>` beside the corners, in the scene, and in libraries.
#[derive(Default)]
pub struct Collada<'a> {
    pub asset: &'a str,
    pub faces: &'a str,
    pub scene: &'a str,
    pub libraries: &'a str,
}

pub fn collada(mesh: &TriMesh, parts: &Collada) -> String {
    let numbers: Vec<String> = mesh.vertices.iter().map(|v| format!("{} {} {}", v.x, v.y, v.z)).collect();
    let indices: Vec<String> = mesh.triangles.iter().flatten().map(u32::to_string).collect();
    let written = format!(
        "<triangles count=\"12\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>{}</p></triangles>",
        indices.join(" ")
    );
    let faces = if parts.faces.is_empty() { &written } else { parts.faces };
    let scene = if parts.scene.is_empty() { "<node><instance_geometry url=\"#g\"/></node>" } else { parts.scene };
    format!(
        "<?xml version=\"1.0\"?>
<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\">
<asset>{}</asset>
<library_geometries><geometry id=\"g\"><mesh>
<source id=\"p\"><float_array id=\"a\" count=\"{}\">{}</float_array>
<technique_common><accessor source=\"#a\" count=\"{}\" stride=\"3\"/></technique_common></source>
<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>
{faces}
</mesh></geometry></library_geometries>
{}
<library_visual_scenes><visual_scene id=\"s\">{scene}</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url=\"#s\"/></scene>
</COLLADA>\n",
        parts.asset,
        3 * numbers.len(),
        numbers.join("\n"),
        numbers.len(),
        parts.libraries
    )
}
