// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

namespace disparityd::tools {

/// A file that is written bit by bit under a temporary name in the same folder (".NAME.part"), and appears by its own
/// name when it is whole. Pipes and devices are written to. Only one process writes a file at a time. One thread uses
/// it.
class GrowingFile {
public:
    /// Throws std::runtime_error when the system refuses, or another process writes it.
    explicit GrowingFile(const std::string& path);
    ~GrowingFile() = default;  ///< without finish() the temporary file stays
    GrowingFile(const GrowingFile&) = delete;
    GrowingFile& operator=(const GrowingFile&) = delete;

    /// Appends. Throws base::DiskFull or std::runtime_error when the system refuses.
    void write(std::string_view text);

    /// Hands over to the system what was written. Throws as write().
    void flush();

    /// Gives the file its name, in place of one that has it, once its content is on the disk. Throws as write().
    /// Nothing is written afterwards.
    void finish();

    /// Returns the temporary name of a file.
    static std::string part_of(const std::string& path);

private:
    struct Close {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };

    std::string path_;
    std::string part_;  ///< the same where nothing is renamed
    std::unique_ptr<std::FILE, Close> file_;
};

}  // namespace disparityd::tools
