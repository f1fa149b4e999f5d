#include "btf/large_array.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <linux/magic.h>
#include <sys/mman.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <new>
#include <string>
#include <utility>

#include "btf/error.h"

namespace weft {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t alignment = 64;

Error no_scratch(const fs::path& folder, int code) {
  return failed(folder.string(), "cannot hold a scratch file: " + system_reason(code),
                "name another folder in TMPDIR, or allow more memory");
}

// An open file that has no name any more: it is gone when it is closed and unmapped, however the
// program ends.
class ScratchFile {
 public:
  ScratchFile(const fs::path& folder, std::size_t size) {
    std::string name = (folder / ".weft-scratch-XXXXXX").string();
    file_ = mkostemp(name.data(), O_CLOEXEC);
    if (file_ < 0) throw no_scratch(folder, errno);
    unlink(name.c_str());
    // All blocks now: a full disk would otherwise end the program at some store into the mapping.
    int code = EINTR;
    while (code == EINTR) code = posix_fallocate(file_, 0, static_cast<off_t>(size));
    if (code != 0) {
      close(file_);
      throw failed(folder.string(),
                   fmt::format("has no room for {:.0f} MiB of scratch: {}",
                               static_cast<double>(size) / (1 << 20), system_reason(code)),
                   "name another folder in TMPDIR, or allow more memory");
    }
  }
  ~ScratchFile() { close(file_); }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  int descriptor() const { return file_; }

 private:
  int file_ = -1;
};

std::byte* mapped_bytes(const fs::path& folder, std::size_t size) {
  const ScratchFile file(folder, size);
  void* data = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, file.descriptor(), 0);
  if (data == MAP_FAILED) throw no_scratch(folder, errno);
  return static_cast<std::byte*>(data);
}

// Large ones in pages of 2 MiB where the system has them: what is read here and there, as the
// samples of raw queries are, would miss the translations of small pages nearly every time.
std::byte* bytes_in_memory(std::size_t size) {
  constexpr std::size_t huge_page = std::size_t{1} << 21;
  const bool is_large = size >= 2 * huge_page;
  const std::size_t unit = is_large ? huge_page : alignment;
  const std::size_t whole = (size + unit - 1) / unit * unit;
  void* data = std::aligned_alloc(unit, whole);
  if (data == nullptr) throw std::bad_alloc();
  if (is_large) madvise(data, whole, MADV_HUGEPAGE);  // no harm where it is refused
  std::memset(data, 0, whole);
  return static_cast<std::byte*>(data);
}

}  // namespace

MemoryBudget::MemoryBudget(std::size_t bytes, fs::path scratch_folder)
    : left_(bytes), scratch_folder_(std::move(scratch_folder)) {}

bool MemoryBudget::take(std::size_t bytes) {
  std::size_t left = left_.load();
  while (left >= bytes) {
    if (left_.compare_exchange_weak(left, left - bytes)) return true;
  }
  return false;
}

bool lies_in_memory(const fs::path& folder) {
  struct statfs system {};
  return statfs(folder.c_str(), &system) == 0 &&
         (system.f_type == TMPFS_MAGIC || system.f_type == RAMFS_MAGIC);
}

LargeBytes::LargeBytes(std::size_t size, std::shared_ptr<MemoryBudget> budget)
    : size_(size), budget_(std::move(budget)) {
  if (size == 0) return;
  mapped_ = budget_ && !budget_->take(size);
  try {
    data_ = mapped_ ? mapped_bytes(budget_->scratch_folder(), size) : bytes_in_memory(size);
  } catch (...) {
    if (budget_ && !mapped_) budget_->give_back(size);
    throw;
  }
}

LargeBytes::LargeBytes(const LargeBytes& other) : LargeBytes(other.size_, other.budget_) {
  if (size_ > 0) std::memcpy(data_, other.data_, size_);
}

LargeBytes::~LargeBytes() {
  if (data_ == nullptr) return;
  if (mapped_) {
    munmap(data_, size_);
    return;
  }
  std::free(data_);
  if (budget_) budget_->give_back(size_);
}

void LargeBytes::swap(LargeBytes& other) noexcept {
  std::swap(data_, other.data_);
  std::swap(size_, other.size_);
  std::swap(mapped_, other.mapped_);
  std::swap(budget_, other.budget_);
}

}  // namespace weft
