// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <stdexcept>
#include <string>

#include "tools/ctl/describe.h"
#include "tools/ctl/growing_file.h"

namespace disparityd::tools {

constexpr const char* manifest_name = "manifest.json";
constexpr const char* geometry_name = "geometry.json";

/// What a finished source was made of and with, and the SHA-256 of what was made (docs/recordings.md). It depends on
/// input, options and version alone: neither on workers and back end, nor on time.
class ManifestWriter {
public:
    /// Throws as GrowingFile does, as all of it.
    ManifestWriter(const std::string& folder, const Json& parameters);

    ~ManifestWriter() = default;  ///< without finish() what is written stays: it says what the folder was begun with
    ManifestWriter(const ManifestWriter&) = delete;
    ManifestWriter& operator=(const ManifestWriter&) = delete;

    void add(const Json& frame);

    /// Adds the members of `rest` behind the frames, and gives the file its name.
    void finish(const Json& rest);

private:
    GrowingFile file_;
    bool any_ = false;
};

/// A manifest.json that is none, such as an empty one after a power cut.
struct DamagedManifest : std::invalid_argument {
    using std::invalid_argument::invalid_argument;
};

/// Returns a folder's manifest without its frames, which `frame` gets one after the other. Throws DamagedManifest, or
/// std::invalid_argument for that of another version, with one line.
Json read_manifest(const std::string& folder, const std::function<void(const Json& frame)>& frame);

/// Returns the SHA-256 of what geometry.json says, but for the back end, on which no result depends.
std::string sha256_of_geometry(Json geometry);

/// Returns the first member that differs and its values: "match.disparities = 32, now 64"; empty: none does. `other`
/// says what the second one is.
std::string difference(const Json& one, const Json& two, const std::string& other);

}  // namespace disparityd::tools
