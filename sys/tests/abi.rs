//! The bindings against C: every struct we touch, as the C compiler lays it out; and the headers against the library.

use std::collections::BTreeMap;
use std::ffi::{CStr, c_char};
use std::mem::{MaybeUninit, align_of, offset_of, size_of};
use std::ptr;

use embree4_sys::*;

#[repr(C)]
struct Fact {
    name: *const c_char,
    value: usize,
}

unsafe extern "C" {
    fn embree4_facts(count: *mut usize) -> *const Fact;
}

/// What the C compiler says, by name.
fn facts_of_c() -> BTreeMap<String, usize> {
    let mut count = 0;
    // SAFETY: the shim writes the length of the static table it returns.
    let table = unsafe { std::slice::from_raw_parts(embree4_facts(&mut count), count) };
    table
        .iter()
        .map(|fact| {
            // SAFETY: names are string literals.
            let name = unsafe { CStr::from_ptr(fact.name) };
            (name.to_str().expect("ASCII").to_owned(), fact.value)
        })
        .collect()
}

/// What the bindings say, by the same names.
fn facts_of_rust() -> BTreeMap<String, usize> {
    let mut facts = BTreeMap::new();
    macro_rules! layout {
        ($t:ident: $($field:ident),+) => {
            facts.insert(concat!(stringify!($t), " size").to_owned(), size_of::<$t>());
            facts.insert(concat!(stringify!($t), " align").to_owned(), align_of::<$t>());
            $(facts.insert(concat!(stringify!($t), ".", stringify!($field)).to_owned(), offset_of!($t, $field));)+
        };
    }
    macro_rules! ray {
        ($($t:ident),+) => { $(layout!($t: org_x, org_y, org_z, tnear, dir_x, dir_y, dir_z, time, tfar, mask, id, flags);)+ };
    }
    macro_rules! hit {
        ($($t:ident),+) => { $(
            layout!($t: Ng_x, Ng_y, Ng_z, u, v, primID, geomID, instID);
            #[cfg(embree4 = "inst_prim_id")]
            layout!($t: instPrimID);
        )+ };
    }
    ray!(RTCRay, RTCRay4, RTCRay8, RTCRay16);
    hit!(RTCHit, RTCHit4, RTCHit8, RTCHit16);
    layout!(RTCRayHit: ray, hit);
    layout!(RTCRayHit4: ray, hit);
    layout!(RTCRayHit8: ray, hit);
    layout!(RTCRayHit16: ray, hit);
    layout!(RTCBounds: lower_x, lower_y, lower_z, align0, upper_x, upper_y, upper_z, align1);
    layout!(RTCRayQueryContext: instID);
    #[cfg(embree4 = "inst_prim_id")]
    layout!(RTCRayQueryContext: instPrimID);
    #[cfg(embree4 = "inst_stack_size")]
    layout!(RTCRayQueryContext: instStackSize);
    layout!(RTCIntersectArguments: flags, feature_mask, context, filter, intersect);
    layout!(RTCOccludedArguments: flags, feature_mask, context, filter, occluded);
    #[cfg(embree4 = "min_width")]
    {
        layout!(RTCIntersectArguments: minWidthDistanceFactor);
        layout!(RTCOccludedArguments: minWidthDistanceFactor);
    }
    layout!(RTCFilterFunctionNArguments: valid, geometryUserPtr, context, ray, hit, N);
    layout!(RTCBoundsFunctionArguments: geometryUserPtr, primID, timeStep, bounds_o);
    layout!(RTCIntersectFunctionNArguments: valid, geometryUserPtr, primID, context, rayhit, N, geomID);
    layout!(RTCOccludedFunctionNArguments: valid, geometryUserPtr, primID, context, ray, N, geomID);
    facts.insert("RTC_VERSION".to_owned(), RTC_VERSION as usize);
    facts.insert("RTC_MAX_INSTANCE_LEVEL_COUNT".to_owned(), RTC_MAX_INSTANCE_LEVEL_COUNT as usize);
    facts
}

#[test]
fn every_struct_is_laid_out_as_in_c() {
    let (c, rust) = (facts_of_c(), facts_of_rust());
    assert!(c.len() > 150, "the shim's table is not the one of this test: {} entries", c.len());
    let differing: Vec<_> = c.keys().chain(rust.keys()).filter(|name| c.get(*name) != rust.get(*name)).collect();
    assert!(differing.is_empty(), "C and Rust differ in {differing:?}\nC: {c:?}\nRust: {rust:?}");
}

#[test]
fn the_library_is_the_one_the_headers_belong_to() {
    // SAFETY: a null configuration is allowed; the device is used only if it was made, and released once.
    unsafe {
        let device = rtcNewDevice(ptr::null());
        assert!(!device.is_null());
        assert_eq!(rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION), RTC_VERSION as isize);
        rtcReleaseDevice(device);
    }
}

#[test]
fn the_inline_functions_set_the_documented_defaults() {
    let mut intersect = MaybeUninit::uninit();
    let mut occluded = MaybeUninit::uninit();
    let mut context = MaybeUninit::uninit();
    // SAFETY: each function initialises every field of the struct it is given.
    let (intersect, occluded, context) = unsafe {
        rtcInitIntersectArguments(intersect.as_mut_ptr());
        rtcInitOccludedArguments(occluded.as_mut_ptr());
        rtcInitRayQueryContext(context.as_mut_ptr());
        (intersect.assume_init(), occluded.assume_init(), context.assume_init())
    };
    assert_eq!(intersect.flags, RTC_RAY_QUERY_FLAG_INCOHERENT);
    assert_eq!(intersect.feature_mask, RTC_FEATURE_FLAG_ALL);
    assert!(intersect.filter.is_none() && intersect.intersect.is_none() && intersect.context.is_null());
    assert_eq!(occluded.flags, RTC_RAY_QUERY_FLAG_INCOHERENT);
    assert_eq!(occluded.feature_mask, RTC_FEATURE_FLAG_ALL);
    assert!(occluded.filter.is_none() && occluded.occluded.is_none() && occluded.context.is_null());
    assert_eq!(context.instID, [INVALID_GEOMETRY_ID; RTC_MAX_INSTANCE_LEVEL_COUNT as usize]);
}

/// A ray-hit between two guards: a library built with other options would write past its end.
#[repr(C)]
struct Guarded {
    before: [u64; 8],
    rayhit: RTCRayHit,
    after: [u64; 8],
}

#[test]
fn a_query_writes_the_hit_and_nothing_beside_it() {
    const GUARD: [u64; 8] = [0x5a5a_1234_dead_beef; 8];
    // SAFETY: the buffers come from Embree with the sizes written to them; the scene is committed before it is
    // queried; every handle is released once.
    unsafe {
        let device = rtcNewDevice(ptr::null());
        let geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
        let vertices =
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, 3).cast::<[f32; 3]>();
        vertices.copy_from_nonoverlapping([[0.0, 0.0, 2.0], [1.0, 0.0, 2.0], [0.0, 1.0, 2.0]].as_ptr(), 3);
        let indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, 1);
        indices.cast::<[u32; 3]>().write([0, 1, 2]);
        rtcCommitGeometry(geometry);
        let scene = rtcNewScene(device);
        rtcAttachGeometryByID(scene, geometry, 7);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene);
        assert_eq!(rtcGetDeviceError(device), RTC_ERROR_NONE);

        let mut guarded = Guarded { before: GUARD, rayhit: RTCRayHit::default(), after: GUARD };
        let ray = &mut guarded.rayhit.ray;
        (ray.org_x, ray.org_y, ray.dir_z, ray.tfar, ray.mask) = (0.25, 0.5, 1.0, f32::INFINITY, u32::MAX);
        guarded.rayhit.hit.geomID = INVALID_GEOMETRY_ID;
        rtcIntersect1(scene, &mut guarded.rayhit, ptr::null_mut());
        assert_eq!((guarded.before, guarded.after), (GUARD, GUARD));
        let RTCRayHit { ray, hit } = guarded.rayhit;
        assert_eq!((ray.tfar, hit.u, hit.v, hit.primID, hit.geomID), (2.0, 0.25, 0.5, 0, 7));
        assert_eq!(hit.instID, [INVALID_GEOMETRY_ID; RTC_MAX_INSTANCE_LEVEL_COUNT as usize]);
        rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }
}
