// Lets Embree build scenes in the calling thread alone, for thread sanitizer.
//
// Debian's Embree is not instrumented: its threads read what lies on the caller's stack, and when
// the caller, who has waited for them, uses that place again, sanitizer sees no order between the
// two. No suppression catches that, as it often cannot tell any more who read. The function here
// stands before the library's own of the same name; what is traced later has all threads.

#include <dlfcn.h>
#include <oneapi/tbb/global_control.h>

#include <cstdlib>

/// @param scene  an RTCScene, a pointer.
extern "C" void rtcCommitScene(void* scene) {
  using Function = void(void*);
  static auto* const next = reinterpret_cast<Function*>(dlsym(RTLD_NEXT, "rtcCommitScene"));
  if (next == nullptr) std::abort();  // another version of Embree: this file must follow it
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  next(scene);
}
