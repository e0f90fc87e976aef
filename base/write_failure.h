// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace disparityd::base {

/// A file could not be written because the disk, or the user's share of it, is full: the same work may succeed later.
class DiskFull : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Throws "PATH: cannot be written: " and the system's text for an error number, which 0 leaves out: DiskFull where
/// that is the cause, else std::runtime_error.
[[noreturn]] void refuse_to_write(const std::string& path, int error);

}  // namespace disparityd::base
