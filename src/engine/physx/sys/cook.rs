//! Convex hulls and meshes, prepared once for all scenes that use them.

use super::{making, physics, watched};
use physx_sys::*;
use std::ffi::c_void;
use std::ptr::{NonNull, null_mut};

/// How near to a hull, as a share of its size, a corner is dropped: some rounding errors of single precision.
const OUTLINE_TOLERANCE: f32 = 1e-6;

/// A convex hull or a mesh as PhysX wants it. Never changes; scenes and threads share it.
pub struct Cooked(pub(super) NonNull<PxRefCounted>);

// SAFETY: nothing writes to it, and PhysX counts its users atomically.
unsafe impl Send for Cooked {}
// SAFETY: as above.
unsafe impl Sync for Cooked {}

impl Drop for Cooked {
    fn drop(&mut self) {
        let _one_at_a_time = making();
        // SAFETY: this is the reference that cooking gave; shapes hold their own.
        unsafe { PxRefCounted_release_mut(self.0.as_ptr()) }
    }
}

impl std::fmt::Debug for Cooked {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Cooked")
    }
}

/// Why there is no hull.
#[derive(Debug, PartialEq)]
pub enum NoHull {
    /// They lie in a plane, or PhysX cannot make one of them.
    Flat,
    /// More corners or faces than PhysX takes, 255.
    TooMany,
}

fn bounded(data: *const c_void, count: usize) -> PxBoundedData {
    // SAFETY: plain numbers; zero is a value of all of them.
    let mut bounded: PxBoundedData = unsafe { std::mem::zeroed() };
    (bounded.stride, bounded.data, bounded.count) = (12, data, u32::try_from(count).unwrap_or(u32::MAX));
    bounded
}

/// The convex hull of these corners.
///
/// # Errors
/// Why it is none.
pub fn cook_hull(corners: &[[f32; 3]]) -> Result<Cooked, NoHull> {
    const MOST: usize = 255;
    let size = corners.iter().flatten().fold(0.0_f32, |size, x| size.max(x.abs()));
    if corners.len() < 4 || !size.is_finite() {
        return Err(NoHull::Flat);
    }
    let physics = physics().map_err(|_| NoHull::Flat)?;
    let mut outcome = PxConvexMeshCookingResult::Failure;
    let one_at_a_time = making();
    // SAFETY: the description points to `corners`, which outlives the call; `outcome` is written by it.
    let made = watched(|| unsafe {
        let mut params = PxCookingParams_new(&PxTolerancesScale_new(1.0, 10.0));
        params.planeTolerance = OUTLINE_TOLERANCE * size;
        let mut desc = PxConvexMeshDesc_new();
        desc.points = bounded(corners.as_ptr().cast(), corners.len());
        desc.flags = PxConvexFlags::ComputeConvex | PxConvexFlags::ShiftVertices;
        let insertion = PxPhysics_getPhysicsInsertionCallback_mut(physics);
        phys_PxCreateConvexMesh(&params, &desc, insertion, &mut outcome)
    });
    // What is dropped below takes it again.
    drop(one_at_a_time);
    let hull = made.ok().and_then(|hull| NonNull::new(hull.cast())).map(Cooked);
    match outcome {
        PxConvexMeshCookingResult::PolygonsLimitReached => Err(NoHull::TooMany),
        // At its limit of corners PhysX stops and says nothing.
        // SAFETY: the hull was just made.
        _ if hull
            .as_ref()
            .is_some_and(|h| unsafe { PxConvexMesh_getNbVertices(h.0.as_ptr().cast()) } as usize >= MOST)
            && corners.len() > MOST =>
        {
            Err(NoHull::TooMany)
        }
        PxConvexMeshCookingResult::Success => hull.ok_or(NoHull::Flat),
        _ => Err(NoHull::Flat),
    }
}

/// A surface of triangles.
///
/// # Errors
/// Indices that do not fit, and what PhysX reports.
pub fn cook_mesh(corners: &[[f32; 3]], triangles: &[[u32; 3]]) -> Result<Cooked, String> {
    let fits = |i: &u32| (*i as usize) < corners.len();
    if triangles.is_empty() || !triangles.iter().flatten().all(fits) || !corners.iter().flatten().all(|x| x.is_finite())
    {
        return Err("physx: a mesh without triangles, with a corner that is not there or not in a finite place".into());
    }
    let physics = physics()?;
    let _one_at_a_time = making();
    // SAFETY: the description points to both slices, which outlive the call; every index is one of a corner.
    let made = watched(|| unsafe {
        let params = PxCookingParams_new(&PxTolerancesScale_new(1.0, 10.0));
        let mut desc = PxTriangleMeshDesc_new();
        desc.points = bounded(corners.as_ptr().cast(), corners.len());
        desc.triangles = bounded(triangles.as_ptr().cast(), triangles.len());
        let insertion = PxPhysics_getPhysicsInsertionCallback_mut(physics);
        phys_PxCreateTriangleMesh(&params, &desc, insertion, null_mut())
    })?;
    NonNull::new(made.cast()).map(Cooked).ok_or_else(|| "physx: a mesh that it cannot take".into())
}
