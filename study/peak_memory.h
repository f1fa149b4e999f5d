// The most memory that a piece of work holds at once.
#pragma once

#include <cstddef>
#include <optional>

namespace weft {

/// Watches the resident set of this process from its making on. Linux keeps the largest one that
/// there ever was and lets it be forgotten (proc(5), clear_refs), so that what ran before hides
/// nothing; memory that was freed and not yet given back is given back first. All threads count,
/// so one is made at a time, around work that nothing else runs beside.
class PeakMemory {
 public:
  PeakMemory();
  /// Bytes by which the resident set was larger at its largest than when this was made; nothing
  /// where the system does not let it be known.
  std::optional<std::size_t> growth() const;

 private:
  std::optional<std::size_t> before_;
};

}  // namespace weft
