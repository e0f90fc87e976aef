// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>
#include <string>

namespace disparityd::base {

/// Returns the system's text for an error number. Where the cause is this program and not the file or device (too many
/// open files, no memory), the text says so and what to do.
std::string error_text(int code);

/// Returns one line for people: the exception's own text, or one of ours where the system gives no more memory. For
/// that libraries have several texts ("std::bad_alloc", "vector::_M_default_append", OpenCV's "Insufficient memory").
std::string failure_text(const std::exception& error);

/// Returns the same for `failure`, which is not null.
std::string failure_text(const std::exception_ptr& failure);

}  // namespace disparityd::base
