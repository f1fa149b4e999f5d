// Tells thread sanitizer the order of TBB's tasks, which it cannot see: Debian's libtbb is not
// instrumented.
//
// Without this every value that a task takes over is reported as a race, and a suppression of all
// that has libtbb on its stack would hide the true ones. The functions here stand before the
// library's own of the same name, for calls out of TBB's headers: a spawned task is carried by one
// that takes over the spawner's order, a wait takes over the order of what was waited for, and
// tasks live in memory whose reuse is seen.

#include <dlfcn.h>
#include <oneapi/tbb/detail/_small_object_pool.h>
#include <oneapi/tbb/detail/_task.h>
#include <sanitizer/tsan_interface.h>

#include <cstdlib>
#include <new>

namespace {

namespace d1 = tbb::detail::d1;

class Carrier final : public d1::task {
 public:
  explicit Carrier(d1::task& carried) : carried_(&carried) { __tsan_release(this); }

  // Where the carried task throws, TBB asks the same carrier to cancel it: so it goes only
  // afterwards.
  d1::task* execute(d1::execution_data& data) override {
    __tsan_acquire(this);
    d1::task* next = carried_->execute(data);
    delete this;
    return next;
  }
  d1::task* cancel(d1::execution_data& data) override {
    __tsan_acquire(this);
    d1::task* next = carried_->cancel(data);
    delete this;
    return next;
  }

 private:
  d1::task* carried_;
};

/// The library's own function behind one of ours.
template <typename Function>
Function* own(const char* mangled_name) {
  void* found = dlsym(RTLD_NEXT, mangled_name);
  if (found == nullptr) std::abort();  // another version of TBB: this file must follow it
  return reinterpret_cast<Function*>(found);
}

/// Takes over the order of a wait's tasks at its end, where one of them threw too. They count
/// `context` down with an atomic in TBB's headers, 8 bytes into it: its last value is their end.
class TakeOver {
 public:
  explicit TakeOver(d1::wait_context& context) : count_(reinterpret_cast<char*>(&context) + 8) {}
  ~TakeOver() { __tsan_acquire(count_); }
  TakeOver(const TakeOver&) = delete;
  TakeOver& operator=(const TakeOver&) = delete;

 private:
  char* count_;
};

void* allocate(std::size_t bytes) {
  return ::operator new (bytes, std::align_val_t{64});
}
void deallocate(void* memory) {
  ::operator delete (memory, std::align_val_t{64});
}

}  // namespace

namespace tbb::detail::r1 {

void spawn(d1::task& task, d1::task_group_context& group) {
  using Function = void(d1::task&, d1::task_group_context&);
  static auto* const next =
      own<Function>("_ZN3tbb6detail2r15spawnERNS0_2d14taskERNS2_18task_group_contextE");
  next(*new Carrier(task), group);
}

void spawn(d1::task& task, d1::task_group_context& group, d1::slot_id slot) {
  using Function = void(d1::task&, d1::task_group_context&, d1::slot_id);
  static auto* const next =
      own<Function>("_ZN3tbb6detail2r15spawnERNS0_2d14taskERNS2_18task_group_contextEt");
  next(*new Carrier(task), group, slot);
}

void execute_and_wait(d1::task& task, d1::task_group_context& group, d1::wait_context& end,
                      d1::task_group_context& end_group) {
  using Function =
      void(d1::task&, d1::task_group_context&, d1::wait_context&, d1::task_group_context&);
  static auto* const next = own<Function>(
      "_ZN3tbb6detail2r116execute_and_waitERNS0_2d14taskERNS2_18task_group_contextERNS2_12wait_"
      "contextES6_");
  const TakeOver at_end(end);
  next(task, group, end, end_group);
}

void wait(d1::wait_context& end, d1::task_group_context& group) {
  using Function = void(d1::wait_context&, d1::task_group_context&);
  static auto* const next =
      own<Function>("_ZN3tbb6detail2r14waitERNS0_2d112wait_contextERNS2_18task_group_contextE");
  const TakeOver at_end(end);
  next(end, group);
}

void* allocate(d1::small_object_pool*&, std::size_t bytes, const d1::execution_data&) {
  return ::allocate(bytes);
}
void* allocate(d1::small_object_pool*&, std::size_t bytes) {
  return ::allocate(bytes);
}
void deallocate(d1::small_object_pool&, void* memory, std::size_t, const d1::execution_data&) {
  ::deallocate(memory);
}
void deallocate(d1::small_object_pool&, void* memory, std::size_t) {
  ::deallocate(memory);
}

}  // namespace tbb::detail::r1
