// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "tools/ctl/processing/process_report.h"

namespace disparityd::tools {

/// The servers whose form of results `process` writes (docs/evaluation.md).
enum class Benchmark : std::uint8_t { kitti2012, kitti2015, middlebury, eth3d };

/// A folder of results as a benchmark's server takes it.
struct Submission {
    Benchmark benchmark = Benchmark::kitti2015;
    std::string folder;
    std::string method;  ///< in the names of Middlebury's files

    /// Whether each pixel must have a disparity: then holes are filled (images::fill_all()). KITTI fills them itself.
    bool dense() const { return benchmark == Benchmark::middlebury || benchmark == Benchmark::eth3d; }
};

/// Reads "kitti2015=FOLDER" and the like. Throws std::invalid_argument with one line for another word, a method's name
/// that no file may have, and a folder that lies in `output`.
Submission parse_submission(const std::string& text, const std::string& method, const std::string& output);

/// Throws std::invalid_argument where two of these sources would have results of one name, and where the folder holds
/// something already and may not: then only what has the same name is replaced.
void check_submission(const Submission& submission, std::span<const std::string> sources, bool may_hold_some);

/// Writes the results of a source, of which `done` names a folder with all frames; returns where they are:
/// "submit/disp_0: 200 results". Throws std::invalid_argument with one line where the source is not of the benchmark's
/// form, its images were rectified or scaled here, or nothing was measured in one; base::DiskFull or std::runtime_error
/// when the system refuses.
std::string write_submission(const Submission& submission, const ProcessDone& done);

}  // namespace disparityd::tools
