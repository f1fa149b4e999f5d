// Arrays that grow with a dataset: in memory while a budget lasts, then in scratch files that are
// mapped into memory.
//
// A mapped page takes no memory that the program must have: the kernel writes it to the file and
// drops it when something else needs the place. So data may be larger than memory, as long as they
// are walked through rather than jumped about in.
#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <type_traits>

namespace weft {

/// How many bytes of memory all arrays that share it may take together, and the folder of the
/// scratch files for those beyond. Thread-safe.
class MemoryBudget {
 public:
  MemoryBudget(std::size_t bytes, std::filesystem::path scratch_folder);

  std::size_t left() const { return left_.load(); }
  const std::filesystem::path& scratch_folder() const { return scratch_folder_; }

  /// Whether as many bytes were left; they are taken then.
  bool take(std::size_t bytes);
  void give_back(std::size_t bytes) { left_ += bytes; }

 private:
  std::atomic<std::size_t> left_;
  std::filesystem::path scratch_folder_;
};

/// Whether a folder's files lie in memory, where they take what they are to save (tmpfs).
bool lies_in_memory(const std::filesystem::path& folder);

/// Zeroed bytes at a multiple of 64, so that sums over them are the same wherever they lie.
class LargeBytes {
 public:
  LargeBytes() = default;
  /// Without a budget in memory. A scratch file has all its blocks from the start, and no name.
  /// @throws Error  failed, where the scratch folder cannot be written to or has no room.
  LargeBytes(std::size_t size, std::shared_ptr<MemoryBudget> budget);
  LargeBytes(const LargeBytes& other);
  LargeBytes(LargeBytes&& other) noexcept { swap(other); }
  LargeBytes& operator=(LargeBytes other) noexcept {
    swap(other);
    return *this;
  }
  ~LargeBytes();

  std::byte* data() const { return data_; }
  std::size_t size() const { return size_; }
  bool mapped() const { return mapped_; }
  const std::shared_ptr<MemoryBudget>& budget() const { return budget_; }

 private:
  void swap(LargeBytes& other) noexcept;

  std::byte* data_ = nullptr;
  std::size_t size_ = 0;
  bool mapped_ = false;
  std::shared_ptr<MemoryBudget> budget_;
};

/// `count` numbers, zero at first.
template <typename Value>
class LargeArray {
  static_assert(std::is_trivially_copyable_v<Value>);

 public:
  LargeArray() = default;
  explicit LargeArray(std::size_t count, std::shared_ptr<MemoryBudget> budget = nullptr)
      : bytes_(count * sizeof(Value), std::move(budget)) {}

  Value* data() { return reinterpret_cast<Value*>(bytes_.data()); }
  const Value* data() const { return reinterpret_cast<const Value*>(bytes_.data()); }
  std::size_t size() const { return bytes_.size() / sizeof(Value); }
  Value& operator[](std::size_t i) { return data()[i]; }
  const Value& operator[](std::size_t i) const { return data()[i]; }
  std::span<Value> values() { return {data(), size()}; }
  std::span<const Value> values() const { return {data(), size()}; }

  /// Whether it lies in a scratch file.
  bool mapped() const { return bytes_.mapped(); }
  const std::shared_ptr<MemoryBudget>& budget() const { return bytes_.budget(); }

 private:
  LargeBytes bytes_;
};

}  // namespace weft
