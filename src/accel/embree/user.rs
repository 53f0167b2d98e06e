//! User geometry: primitives that Embree bounds and intersects through safe Rust code.

use std::any::Any;
use std::ffi::c_void;
use std::mem::offset_of;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use embree4_sys as sys;

use crate::math::{Ray, Vec3};

/// A set of primitives with code of their own. Embree calls it from any thread, also while it builds.
pub(super) trait UserGeometry: Send + Sync + 'static {
    /// How many primitives there are.
    fn len(&self) -> usize;

    /// Lower and upper corner of a box around a primitive. Whatever `intersect` accepts must lie in it, with room
    /// for the traversal's roundings.
    fn bounds(&self, primitive: u32) -> (Vec3, Vec3);

    /// Where the ray first meets a primitive, with a parameter in `[tmin, tmax]`.
    fn intersect(&self, primitive: u32, ray: &Ray) -> Option<UserHit>;
}

/// A ray's parameter where it meets a primitive, and the coordinates there, of primitives that have such.
#[derive(Clone, Copy, Debug)]
pub(super) struct UserHit {
    pub(super) t: f32,
    pub(super) u: f32,
    pub(super) v: f32,
}

impl UserHit {
    /// Of a primitive without coordinates.
    pub(super) fn at(t: f32) -> Self {
        Self { t, u: 0.0, v: 0.0 }
    }
}

/// Carries a panic over Embree's frames, which must not be unwound: caught in the callback, raised again by the
/// query that Embree returns to.
#[derive(Default)]
pub(super) struct PanicRelay {
    raised: AtomicBool,
    payload: Mutex<Option<Box<dyn Any + Send>>>,
}

impl PanicRelay {
    fn keep(&self, payload: Box<dyn Any + Send>) {
        let mut slot = self.payload.lock().unwrap_or_else(PoisonError::into_inner);
        slot.get_or_insert(payload);
        self.raised.store(true, Ordering::Release);
    }

    /// Panics if a callback did.
    #[inline]
    pub(super) fn raise(&self) {
        if self.raised.load(Ordering::Relaxed) {
            self.raise_now();
        }
    }

    #[cold]
    fn raise_now(&self) -> ! {
        let payload = self.payload.lock().unwrap_or_else(PoisonError::into_inner).take();
        match payload {
            Some(payload) => resume_unwind(payload),
            // Taken by another thread; this one's query is no more to be trusted.
            None => panic!("the code of a user geometry panicked in an earlier query"),
        }
    }
}

/// What `geometryUserPtr` points to.
pub(super) struct UserData<U> {
    geometry: U,
    panics: Arc<PanicRelay>,
}

impl<U: UserGeometry> UserData<U> {
    pub(super) fn new(geometry: U, panics: Arc<PanicRelay>) -> Self {
        Self { geometry, panics }
    }

    pub(super) fn len(&self) -> usize {
        self.geometry.len()
    }

    /// Installs the callbacks.
    ///
    /// # Safety
    /// `geometry` is a valid user geometry, not attached yet, and `self` stays where it is until Embree has released
    /// it.
    pub(super) unsafe fn install(&self, geometry: sys::RTCGeometry) {
        let this = (&raw const *self).cast_mut().cast::<c_void>();
        // SAFETY: the callbacks are those for `UserData<U>`, which is what the user pointer is.
        unsafe {
            sys::rtcSetGeometryUserData(geometry, this);
            sys::rtcSetGeometryBoundsFunction(geometry, Some(bounds::<U>), std::ptr::null_mut());
            sys::rtcSetGeometryIntersectFunction(geometry, Some(intersect::<U>));
            sys::rtcSetGeometryOccludedFunction(geometry, Some(occluded::<U>));
        }
    }

    /// Runs the user's code; a panic is kept and counts as no answer.
    fn guarded<R>(&self, run: impl FnOnce(&U) -> R) -> Option<R> {
        // Unwind safety: after a panic the scene is not used again but to report it.
        match catch_unwind(AssertUnwindSafe(|| run(&self.geometry))) {
            Ok(result) => Some(result),
            Err(payload) => {
                self.panics.keep(payload);
                None
            }
        }
    }
}

unsafe extern "C" fn bounds<U: UserGeometry>(args: *const sys::RTCBoundsFunctionArguments) {
    // SAFETY: Embree passes valid arguments.
    let args = unsafe { &*args };
    // SAFETY: the user pointer is the one that `install` set.
    let user = unsafe { &*args.geometryUserPtr.cast::<UserData<U>>() };
    let (lo, hi) = user.guarded(|g| g.bounds(args.primID)).unwrap_or((Vec3::ZERO, Vec3::ZERO));
    let bounds = sys::RTCBounds {
        lower_x: lo.x,
        lower_y: lo.y,
        lower_z: lo.z,
        align0: 0.0,
        upper_x: hi.x,
        upper_y: hi.y,
        upper_z: hi.z,
        align1: 0.0,
    };
    // SAFETY: Embree passes a place to write the box to.
    unsafe { args.bounds_o.write(bounds) };
}

/// The index of a field of `RTCRay`/`RTCRayHit` among its 4-byte lanes: in a packet of N the field starts at N times
/// that (`RTCRayN_org_x` and its like in `rtcore_ray.h`; the ABI tests check the widths 1, 4, 8 and 16).
macro_rules! lane {
    (ray $field:ident) => {
        offset_of!(sys::RTCRay, $field) / 4
    };
    (hit $field:ident) => {
        (offset_of!(sys::RTCRayHit, hit) + offset_of!(sys::RTCHit, $field)) / 4
    };
}

/// Ray `i` of a packet of `n`.
///
/// # Safety
/// `packet` points to an `RTCRayN` or `RTCRayHitN` of `n` rays, and `i < n`.
#[inline]
unsafe fn read_ray(packet: *const f32, n: usize, i: usize) -> Ray {
    // SAFETY: each lane index is within the packet by this function's contract.
    let at = |lane: usize| unsafe { packet.add(lane * n + i).read() };
    Ray {
        o: Vec3::new(at(lane!(ray org_x)), at(lane!(ray org_y)), at(lane!(ray org_z))),
        d: Vec3::new(at(lane!(ray dir_x)), at(lane!(ray dir_y)), at(lane!(ray dir_z))),
        tmin: at(lane!(ray tnear)),
        tmax: at(lane!(ray tfar)),
    }
}

unsafe extern "C" fn intersect<U: UserGeometry>(args: *const sys::RTCIntersectFunctionNArguments) {
    // SAFETY: Embree passes valid arguments.
    let args = unsafe { &*args };
    // SAFETY: the user pointer is the one that `install` set.
    let user = unsafe { &*args.geometryUserPtr.cast::<UserData<U>>() };
    let (packet, n) = (args.rayhit.cast::<f32>(), args.N as usize);
    user.guarded(|geometry| {
        for i in 0..n {
            // SAFETY: `valid` has `n` entries: 0 for the rays to leave alone, else −1.
            if unsafe { args.valid.add(i).read() } == 0 {
                continue;
            }
            // SAFETY: the packet has `n` rays.
            let ray = unsafe { read_ray(packet, n, i) };
            let Some(UserHit { t, u, v }) = geometry.intersect(args.primID, &ray) else { continue };
            // SAFETY: as for reading; the two identifiers' lanes hold unsigned integers.
            unsafe {
                packet.add(lane!(ray tfar) * n + i).write(t);
                packet.add(lane!(hit u) * n + i).write(u);
                packet.add(lane!(hit v) * n + i).write(v);
                packet.add(lane!(hit primID) * n + i).cast::<u32>().write(args.primID);
                packet.add(lane!(hit geomID) * n + i).cast::<u32>().write(args.geomID);
            }
        }
    });
}

unsafe extern "C" fn occluded<U: UserGeometry>(args: *const sys::RTCOccludedFunctionNArguments) {
    // SAFETY: Embree passes valid arguments.
    let args = unsafe { &*args };
    // SAFETY: the user pointer is the one that `install` set.
    let user = unsafe { &*args.geometryUserPtr.cast::<UserData<U>>() };
    let (packet, n) = (args.ray.cast::<f32>(), args.N as usize);
    user.guarded(|geometry| {
        for i in 0..n {
            // SAFETY: `valid` has `n` entries: 0 for the rays to leave alone, else −1.
            if unsafe { args.valid.add(i).read() } == 0 {
                continue;
            }
            // SAFETY: the packet has `n` rays.
            let ray = unsafe { read_ray(packet, n, i) };
            if geometry.intersect(args.primID, &ray).is_some() {
                // SAFETY: as for reading. −∞ is Embree's mark of an occluded ray.
                unsafe { packet.add(lane!(ray tfar) * n + i).write(f32::NEG_INFINITY) };
            }
        }
    });
}
