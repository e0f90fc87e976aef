// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "obstacles/scan_stage.h"
#include "tools/ctl/growing_file.h"

namespace disparityd::tools {

/// Says which frame a scan is of.
struct ScanMoment {
    std::uint64_t frame = 0;  ///< counted from 0
    std::uint64_t sequence = 0;
    std::int64_t monotonic_ns = 0;
};

/// Returns the first line of the file, and the lines of a frame: one for each sector. What is not known is an empty
/// field. The same scan gives the same bytes.
std::string scan_csv_head();
std::string scan_csv_rows(const ScanMoment& moment, const ScanRecord& scan);

/// A file of scans, whole frames at a time. One thread uses it, and only one process.
class ScanCsv {
public:
    /// Makes the file. Throws std::invalid_argument when it is there already and `force` is false, std::runtime_error
    /// when another process writes it or the system refuses.
    ScanCsv(const std::string& path, bool force);

    /// Throws std::runtime_error when the rows cannot be written.
    void write(const ScanMoment& moment, const ScanRecord& scan);

    /// Gives the file its name, which it has not before. Throws as write().
    void finish() { file_.finish(); }

private:
    GrowingFile file_;
};

}  // namespace disparityd::tools
