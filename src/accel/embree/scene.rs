//! Embree scenes: one under construction, one committed. Only the second can be queried, and it cannot change.

use std::ptr;
use std::sync::Arc;

use embree4_sys as sys;

use super::device::Device;
use super::user::{PanicRelay, UserData, UserGeometry};
use crate::accel::AccelError;
use crate::geometry::Geometry;
use crate::math::{Ray, Vec3};

// Embree reads 16 bytes per vertex, also of the last one.
const _: () = assert!(size_of::<Vec3>() == 16 && align_of::<Vec3>() >= 4);

/// Which rays see which geometry: a geometry is met only by rays that share a bit with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct RayMask(u32);

impl RayMask {
    /// Surfaces that are opaque, and the rays that only these block.
    pub(super) const OPAQUE: Self = Self(1 << 0);
    /// Queries for delta points, and the delta points.
    pub(super) const DELTA: Self = Self(1 << 1);
    /// Surfaces that are partly opaque, and queries for them.
    pub(super) const CUT_OUT: Self = Self(1 << 2);
    /// The rays that carry light: they meet all surfaces.
    pub(super) const TRANSPORT: Self = Self(Self::OPAQUE.0 | Self::CUT_OUT.0);
}

/// What a ray met first.
#[derive(Clone, Copy, Debug)]
pub(super) struct RawHit {
    pub(super) t: f32,
    pub(super) u: f32,
    pub(super) v: f32,
    pub(super) geometry: u32,
    pub(super) primitive: u32,
}

/// An owned scene handle with all that Embree reads through it.
struct SceneHandle {
    raw: sys::RTCScene,
    /// Shared buffers and user data, dropped after the scene's release.
    keep: Vec<Arc<dyn Send + Sync>>,
    panics: Arc<PanicRelay>,
    device: Arc<Device>,
}

impl Drop for SceneHandle {
    fn drop(&mut self) {
        // SAFETY: the handle is valid and this is its one release; geometries go with it, before `keep` is dropped.
        unsafe { sys::rtcReleaseScene(self.raw) };
    }
}

/// A geometry that is not attached yet.
struct GeometryHandle(sys::RTCGeometry);

impl GeometryHandle {
    fn new(device: &Device, kind: sys::RTCGeometryType) -> Result<Self, AccelError> {
        // SAFETY: the device is valid.
        let raw = unsafe { sys::rtcNewGeometry(device.handle(), kind) };
        if raw.is_null() {
            device.check("make a geometry")?;
            return Err(AccelError { message: "Embree could not make a geometry, and gives no reason".to_owned() });
        }
        Ok(Self(raw))
    }
}

impl Drop for GeometryHandle {
    fn drop(&mut self) {
        // SAFETY: the handle is valid and this is our one release; a scene it is attached to holds its own reference.
        unsafe { sys::rtcReleaseGeometry(self.0) };
    }
}

/// A scene under construction.
pub(super) struct SceneBuilder(SceneHandle);

impl SceneBuilder {
    /// An empty scene: robust traversal (watertight, conservative boxes), the best trees.
    ///
    /// # Errors
    /// When Embree runs out of memory.
    pub(super) fn new(device: &Arc<Device>) -> Result<Self, AccelError> {
        // SAFETY: the device is valid.
        let raw = unsafe { sys::rtcNewScene(device.handle()) };
        if raw.is_null() {
            device.check("make a scene")?;
            return Err(AccelError { message: "Embree could not make a scene, and gives no reason".to_owned() });
        }
        let device = Arc::clone(device);
        let scene = Self(SceneHandle { raw, keep: Vec::new(), panics: Arc::default(), device });
        // SAFETY: the scene is valid and not committed yet.
        unsafe {
            sys::rtcSetSceneFlags(raw, sys::RTC_SCENE_FLAG_ROBUST);
            sys::rtcSetSceneBuildQuality(raw, sys::RTC_BUILD_QUALITY_HIGH);
        }
        scene.0.device.check("configure a scene")?;
        Ok(scene)
    }

    /// Attaches triangles over the vertices of `geometry` as geometry `id`: all of them, or those given as corners. Embree
    /// reads vertices and indices in place.
    ///
    /// # Errors
    /// When an index is out of range or there are too many triangles or vertices for 32-bit indices.
    pub(super) fn attach_triangles(
        &mut self,
        geometry: &Arc<Geometry>,
        some: Option<Vec<[u32; 3]>>,
        id: u32,
        mask: RayMask,
    ) -> Result<(), AccelError> {
        let keep = Arc::new((Arc::clone(geometry), some));
        let (positions, triangles) = (&keep.0.positions, keep.1.as_ref().unwrap_or(&keep.0.triangles));
        // Embree itself does not look: an index past the end would be read.
        if let Some(bad) = triangles.iter().position(|t| t.iter().any(|&i| i as usize >= positions.len())) {
            return Err(AccelError {
                message: format!(
                    "triangle {bad} has the vertices {:?}, but there are only {}",
                    triangles[bad],
                    positions.len()
                ),
            });
        }
        check_count("triangles", triangles.len())?;
        let handle = GeometryHandle::new(&self.0.device, sys::RTC_GEOMETRY_TYPE_TRIANGLE)?;
        // SAFETY: both buffers belong to `keep`, which nothing can change while the `Arc` kept below lives, and
        // have the strides and lengths given; a `Vec3` has the padding that Embree reads behind its third float.
        unsafe {
            sys::rtcSetSharedGeometryBuffer(
                handle.0,
                sys::RTC_BUFFER_TYPE_VERTEX,
                0,
                sys::RTC_FORMAT_FLOAT3,
                positions.as_ptr().cast(),
                0,
                size_of::<Vec3>(),
                positions.len(),
            );
            sys::rtcSetSharedGeometryBuffer(
                handle.0,
                sys::RTC_BUFFER_TYPE_INDEX,
                0,
                sys::RTC_FORMAT_UINT3,
                triangles.as_ptr().cast(),
                0,
                size_of::<[u32; 3]>(),
                triangles.len(),
            );
        }
        self.0.device.check("take the triangles' buffers")?;
        self.attach(&handle, id, mask, keep)
    }

    /// Attaches primitives with code of their own as geometry `id`.
    ///
    /// # Errors
    /// When there are too many primitives for 32-bit indices.
    pub(super) fn attach_user<U: UserGeometry>(
        &mut self,
        geometry: U,
        id: u32,
        mask: RayMask,
    ) -> Result<(), AccelError> {
        let user = Arc::new(UserData::new(geometry, Arc::clone(&self.0.panics)));
        let count = check_count("primitives", user.len())?;
        let handle = GeometryHandle::new(&self.0.device, sys::RTC_GEOMETRY_TYPE_USER)?;
        // SAFETY: the geometry is a user geometry; `user` is kept, behind its `Arc`, until after the scene's release.
        unsafe {
            sys::rtcSetGeometryUserPrimitiveCount(handle.0, count);
            user.install(handle.0);
        }
        self.0.device.check("set up a user geometry")?;
        self.attach(&handle, id, mask, user)
    }

    fn attach(
        &mut self,
        handle: &GeometryHandle,
        id: u32,
        mask: RayMask,
        keep: Arc<dyn Send + Sync>,
    ) -> Result<(), AccelError> {
        // First of all: from here on the scene may hold pointers into it.
        self.0.keep.push(keep);
        // SAFETY: scene and geometry are valid and of the same device; the geometry is complete.
        unsafe {
            sys::rtcSetGeometryMask(handle.0, mask.0);
            sys::rtcCommitGeometry(handle.0);
            sys::rtcAttachGeometryByID(self.0.raw, handle.0, id);
        }
        self.0.device.check("attach a geometry")
    }

    /// Builds the trees, with Embree's own threads. Nearest hits are found for `rays`, occlusion for `blocked`.
    ///
    /// # Errors
    /// When Embree runs out of memory.
    pub(super) fn commit(self, rays: RayMask, blocked: RayMask) -> Result<Scene, AccelError> {
        // SAFETY: the scene is valid and all its geometries are committed.
        unsafe { sys::rtcCommitScene(self.0.raw) };
        self.0.panics.raise();
        self.0.device.check("build the scene's trees")?;
        Ok(Scene { handle: self.0, mask: rays.0, blocked: blocked.0 })
    }
}

fn check_count(what: &str, count: usize) -> Result<u32, AccelError> {
    // `u32::MAX` is Embree's "no primitive".
    match u32::try_from(count) {
        Ok(count) if count < u32::MAX => Ok(count),
        _ => {
            Err(AccelError { message: format!("{count} {what} are more than the 2³² − 2 that Embree can number") })
        }
    }
}

/// A committed scene, queried with rays of one mask for nearest hits and of one for occlusion.
pub(super) struct Scene {
    handle: SceneHandle,
    mask: u32,
    blocked: u32,
}

// SAFETY: queries of a committed scene are thread-safe, and no other operation is offered; what the scene reads
// (`keep`) is `Send + Sync`.
unsafe impl Send for Scene {}
// SAFETY: as above.
unsafe impl Sync for Scene {}

/// Where a segment starts: Embree leaves negative parameters undefined; as with the other backend they count as 0. A
/// NaN stays one: nothing is met.
#[inline]
fn from_zero(tmin: f32) -> f32 {
    if tmin < 0.0 { 0.0 } else { tmin }
}

/// Whether a ray can meet anything at all: Embree leaves queries with other rays undefined.
#[inline]
fn is_sound(ray: &Ray) -> bool {
    ray.o.is_finite() && ray.d.is_finite() && ray.d != Vec3::ZERO
}

impl Scene {
    #[inline]
    fn ray(ray: &Ray, mask: u32) -> sys::RTCRay {
        sys::RTCRay {
            org_x: ray.o.x,
            org_y: ray.o.y,
            org_z: ray.o.z,
            tnear: from_zero(ray.tmin),
            dir_x: ray.d.x,
            dir_y: ray.d.y,
            dir_z: ray.d.z,
            time: 0.0,
            tfar: ray.tmax,
            mask,
            id: 0,
            flags: 0,
        }
    }

    /// The nearest hit.
    #[inline]
    pub(super) fn intersect(&self, ray: &Ray) -> Option<RawHit> {
        if !is_sound(ray) {
            return None;
        }
        let mut query = sys::RTCRayHit { ray: Self::ray(ray, self.mask), hit: sys::RTCHit::default() };
        query.hit.geomID = sys::INVALID_GEOMETRY_ID;
        // SAFETY: the scene is committed; the struct has the size and alignment of the linked library's (sys's ABI
        // tests); without arguments Embree takes its defaults.
        unsafe { sys::rtcIntersect1(self.handle.raw, &mut query, ptr::null_mut()) };
        self.handle.panics.raise();
        let sys::RTCRayHit { ray, hit } = query;
        (hit.geomID != sys::INVALID_GEOMETRY_ID).then_some(RawHit {
            t: ray.tfar,
            u: hit.u,
            v: hit.v,
            geometry: hit.geomID,
            primitive: hit.primID,
        })
    }

    /// Whether anything lies on the segment.
    #[inline]
    pub(super) fn occluded(&self, ray: &Ray) -> bool {
        if !is_sound(ray) {
            return false;
        }
        let mut query = Self::ray(ray, self.blocked);
        // SAFETY: as for `intersect`.
        unsafe { sys::rtcOccluded1(self.handle.raw, &mut query, ptr::null_mut()) };
        self.handle.panics.raise();
        // Embree marks an occluded ray by tfar = −∞; a segment with that end is not one.
        query.tfar == f32::NEG_INFINITY
    }

    /// `occluded` for up to eight rays at once.
    #[inline]
    pub(super) fn occluded8(&self, rays: &[Ray], out: &mut [bool]) {
        debug_assert!(rays.len() <= 8 && rays.len() == out.len());
        let mut valid = Valid8([0; 8]);
        let mut packet = sys::RTCRay8 { mask: [self.blocked; 8], ..sys::RTCRay8::default() };
        for (i, ray) in rays.iter().enumerate().take(8) {
            if !is_sound(ray) {
                continue;
            }
            valid.0[i] = -1;
            (packet.org_x[i], packet.org_y[i], packet.org_z[i]) = ray.o.into();
            (packet.dir_x[i], packet.dir_y[i], packet.dir_z[i]) = ray.d.into();
            (packet.tnear[i], packet.tfar[i]) = (from_zero(ray.tmin), ray.tmax);
        }
        // SAFETY: as for `intersect`; mask and packet are aligned to 32 bytes by their types.
        unsafe { sys::rtcOccluded8(valid.0.as_ptr(), self.handle.raw, &mut packet, ptr::null_mut()) };
        self.handle.panics.raise();
        for (i, blocked) in out.iter_mut().enumerate().take(8) {
            *blocked = valid.0[i] != 0 && packet.tfar[i] == f32::NEG_INFINITY;
        }
    }
}

/// A packet's mask of rays to trace, aligned as Embree asks.
#[repr(align(32))]
struct Valid8([i32; 8]);
