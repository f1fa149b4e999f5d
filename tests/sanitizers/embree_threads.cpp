// Keeps Embree to the calling thread where it builds a scene, for thread sanitizer.
//
// Debian's Embree is not instrumented: its threads read what lies on the caller's stack, and when
// the caller, who has waited for them, uses that place again, sanitizer sees no order between the
// two. No suppression catches that, as it often cannot tell any more who read. The function here
// stands before the library's own of the same name.

#include <dlfcn.h>

#include <cstdlib>
#include <string>

// RTCDevice, a pointer.
extern "C" void* rtcNewDevice(const char* config) {
  using Function = void*(const char*);
  static auto* const next = reinterpret_cast<Function*>(dlsym(RTLD_NEXT, "rtcNewDevice"));
  if (next == nullptr) std::abort();
  const std::string settings = config != nullptr ? config : "";
  return next((settings.empty() ? "threads=1" : settings + ",threads=1").c_str());
}
