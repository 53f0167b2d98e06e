//! The Embree device: errors, properties, instruction set.

use std::ffi::{CStr, CString, c_char, c_void};
use std::ptr;
use std::sync::{Mutex, PoisonError};

use embree4_sys as sys;

use crate::accel::AccelError;

/// At most this many messages are kept: the first ones tell what went wrong.
const MAX_MESSAGES: usize = 16;

/// What Embree's error callback received, oldest first.
type Messages = Mutex<Vec<String>>;

/// An Embree device. Scenes hold it by `Arc`, so that it outlives them and the callback's messages outlive it.
pub(super) struct Device {
    handle: sys::RTCDevice,
    /// Boxed: Embree holds its address.
    messages: Box<Messages>,
}

// SAFETY: Embree's API is thread-safe for a shared device handle (its error codes are per thread), and the messages
// are behind a mutex.
unsafe impl Send for Device {}
// SAFETY: as above.
unsafe impl Sync for Device {}

/// Embree's error callback: keeps the message for `Device::check` to report.
unsafe extern "C" fn on_error(messages: *mut c_void, code: sys::RTCError, text: *const c_char) {
    // SAFETY: the pointer is the box that `Device::new` registered; it outlives the device.
    let messages = unsafe { &*messages.cast::<Messages>() };
    // SAFETY: Embree passes a NUL-terminated string or null.
    let text = unsafe { string(text) };
    let mut messages = messages.lock().unwrap_or_else(PoisonError::into_inner);
    if messages.len() < MAX_MESSAGES {
        messages.push(if text.is_empty() { error_name(code) } else { text });
    }
}

/// A C string as a Rust string; empty for null.
///
/// # Safety
/// `text` is null or NUL-terminated.
unsafe fn string(text: *const c_char) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: not null, and NUL-terminated by this function's contract.
    unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned()
}

/// Embree's own words for an error code, for example `Out of memory`.
fn error_name(code: sys::RTCError) -> String {
    // SAFETY: the function takes any code and returns a static string.
    unsafe { string(sys::rtcGetErrorString(code)) }
}

/// The error of a failed call: what was being done, what Embree said, what to do.
fn failure(doing: &str, code: sys::RTCError, said: &str) -> AccelError {
    let remedy = match code {
        sys::RTC_ERROR_OUT_OF_MEMORY => "use a smaller scene or a machine with more memory",
        sys::RTC_ERROR_UNSUPPORTED_CPU => "this processor is not supported by this build of Embree: use --accel bvh",
        _ => "use --accel bvh, and report this as a defect",
    };
    let name = error_name(code);
    let said = if said.is_empty() { name } else { format!("{said} ({name})") };
    AccelError { message: format!("Embree could not {doing}: {said}. What to do: {remedy}") }
}

impl Device {
    /// A device whose scenes are built by so many threads, 0 for one per logical processor; queries run on the threads
    /// that ask.
    ///
    /// # Errors
    /// When Embree does not run on this processor, or the library loaded is older than the headers the bindings were
    /// made from.
    pub(super) fn new(threads: u32) -> Result<Self, AccelError> {
        let configuration = CString::new(format!("threads={threads}")).unwrap_or_default();
        // SAFETY: the configuration is NUL-terminated; Embree keeps no pointer to it.
        let handle = unsafe { sys::rtcNewDevice(configuration.as_ptr()) };
        if handle.is_null() {
            // SAFETY: without a device both report on the thread's failed attempt to make one.
            let (code, said) = unsafe {
                (sys::rtcGetDeviceError(ptr::null_mut()), string(sys::rtcGetDeviceLastErrorMessage(ptr::null_mut())))
            };
            return Err(failure("start", code, &said));
        }
        let device = Self { handle, messages: Box::default() };
        let address = (&raw const *device.messages).cast_mut().cast::<c_void>();
        // SAFETY: the handle is valid; the box lives as long as `device`, which releases the handle first.
        unsafe { sys::rtcSetDeviceErrorFunction(handle, Some(on_error), address) };
        let loaded = device.property(sys::RTC_DEVICE_PROPERTY_VERSION);
        if loaded < sys::RTC_VERSION as isize {
            return Err(AccelError {
                message: format!(
                    "the Embree that was loaded ({}) is older than the one this program was built with ({}). What to \
                     do: correct LD_LIBRARY_PATH, or build again",
                    device.version(),
                    sys::RTC_VERSION_STRING.escape_ascii().to_string().trim_end_matches("\\x00"),
                ),
            });
        }
        device.check("start")?;
        Ok(device)
    }

    /// The raw handle, valid while `self` lives.
    pub(super) fn handle(&self) -> sys::RTCDevice {
        self.handle
    }

    /// Turns an error that Embree noted on this thread since the last check into one of ours.
    ///
    /// # Errors
    /// When a call since the last check failed; `doing` says what it was for, after "could not".
    pub(super) fn check(&self, doing: &str) -> Result<(), AccelError> {
        // SAFETY: the handle is valid; the call clears this thread's error code.
        let code = unsafe { sys::rtcGetDeviceError(self.handle) };
        if code == sys::RTC_ERROR_NONE {
            return Ok(());
        }
        let said = std::mem::take(&mut *self.messages.lock().unwrap_or_else(PoisonError::into_inner));
        Err(failure(doing, code, &said.join("; ")))
    }

    /// A property of the device; 0 when Embree does not know it.
    pub(super) fn property(&self, property: sys::RTCDeviceProperty) -> isize {
        // SAFETY: the handle is valid.
        unsafe { sys::rtcGetDeviceProperty(self.handle, property) }
    }

    /// The version of the library that was loaded, for example `4.3.3`.
    pub(super) fn version(&self) -> String {
        let part = |p| self.property(p);
        format!(
            "{}.{}.{}",
            part(sys::RTC_DEVICE_PROPERTY_VERSION_MAJOR),
            part(sys::RTC_DEVICE_PROPERTY_VERSION_MINOR),
            part(sys::RTC_DEVICE_PROPERTY_VERSION_PATCH)
        )
    }

    /// The instruction set Embree traverses with, as it spells it.
    ///
    /// Embree has no query for it. The packet widths it calls native say which vector width it chose; within a
    /// width it takes the newest set that the processor has.
    pub(super) fn isa(&self) -> &'static str {
        #[cfg(target_arch = "x86_64")]
        {
            if self.property(sys::RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) != 0 {
                "AVX512"
            } else if self.property(sys::RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) != 0 {
                let avx2 = is_x86_feature_detected!("avx2")
                    && is_x86_feature_detected!("fma")
                    && is_x86_feature_detected!("f16c")
                    && is_x86_feature_detected!("lzcnt")
                    && is_x86_feature_detected!("bmi1")
                    && is_x86_feature_detected!("bmi2");
                if avx2 { "AVX2" } else { "AVX" }
            } else if is_x86_feature_detected!("sse4.2") {
                "SSE4.2"
            } else {
                "SSE2"
            }
        }
        #[cfg(target_arch = "aarch64")]
        {
            "NEON"
        }
        #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
        {
            std::env::consts::ARCH
        }
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: the handle is valid and this is its one release; scenes hold an `Arc` of `self`, so none is left.
        unsafe { sys::rtcReleaseDevice(self.handle) };
    }
}
