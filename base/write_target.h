// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include <sys/types.h>

namespace disparityd::base {

/// Where what is written under a name really goes.
struct WriteTarget {
    std::string path;            ///< what a link leads to, whether that is there or not: the link stays one
    bool special = false;        ///< a pipe or a device: it is written to, never replaced
    std::optional<mode_t> mode;  ///< permissions of the file that is there, for the one that takes its place
};

/// Throws as refuse_to_write() where a file is there that must not be written: who replaces it needs no right to it.
WriteTarget write_target(const std::string& path);

}  // namespace disparityd::base
