// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace disparityd::capture {

/// Returns a text with stars for what may be a password: the user of an address, as in rtsp://user:password@host, and
/// values of properties such as user-pw.
std::string without_passwords(const std::string& text);

/// Returns the URI of a source as it is shown: in names, tags and logs.
std::string shown_source(const std::string& uri);

}  // namespace disparityd::capture
