// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "tools/ctl/describe.h"

namespace disparityd::tools {

/// Returns the parameters (see parameters_of()) of the run in a folder, finished or not, as its manifest begins with
/// them; nothing where no manifest was begun.
std::optional<Json> begun_with(const std::string& folder);

/// Throws std::invalid_argument with one line where the run in the folder was made with other things than now.
void check_made_with(const std::string& folder, const Json& made, const Json& now);

/// The same of its parameters, finished or not; those of a folder without a run are not compared.
void check_begun_with(const std::string& folder, const Json& parameters);

/// A run that has its manifest.
struct MadeRun {
    Json manifest;  ///< without frames
    std::uint64_t frames = 0;
    /// Why it is not done all the same: "out/000001.png: is missing or empty", or that frames were left out, as what
    /// kept them from being read may have passed. Empty: it is done.
    std::string lack;
};

/// Reads it. `scan` is the file of the obstacle scans; empty: none. Of a range of --split, `whole` is the folder to
/// which a join that was killed may have moved its files; empty: none. Throws as read_manifest().
MadeRun made_run(const std::string& folder, const std::string& scan, const std::string& whole);

/// Whether it is done; not where its manifest is damaged. Else as made_run().
bool is_done(const std::string& folder, const std::string& scan, const std::string& whole);

}  // namespace disparityd::tools
