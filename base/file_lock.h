// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace disparityd::base {

/// Makes this process the only writer of an open file or folder until the descriptor is closed. Throws
/// std::runtime_error with one line when another program of this project writes it; the line names the process where
/// the system knows it. `path` is for the message. Does nothing where the file system has no locks.
void lock_for_writing(int descriptor, const std::string& path);

/// Returns the process that holds a lock (flock) of an open file, such as " (process 123, disparityctl)"; empty where
/// the system does not say.
std::string lock_holder(int descriptor);

}  // namespace disparityd::base
