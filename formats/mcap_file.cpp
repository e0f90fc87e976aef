// SPDX-License-Identifier: Apache-2.0
#include "formats/mcap_file.h"

#include <cerrno>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file_lock.h"
#include "base/write_all.h"
#include "base/write_failure.h"
#include "base/write_target.h"

namespace disparityd::formats {
namespace {

constexpr std::chrono::seconds sync_period{1};

/// Waits until the disk has the file's name, too. What cannot be asked for is left out.
void sync_folder_of(const std::string& path) {
    const std::filesystem::path parent = std::filesystem::path(path).parent_path();
    const int folder = ::open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder >= 0) {
        ::fsync(folder);
        ::close(folder);
    }
}

/// Opens a file for writing. Throws as the constructor of McapFile.
int open_to_write(const std::string& path, const base::WriteTarget& target, bool must_be_new) {
    constexpr mode_t mode = 0640;
    const int descriptor =
        ::open(target.path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | (must_be_new ? O_EXCL : 0), mode);
    if (descriptor < 0 && must_be_new && errno == EEXIST) {
        throw std::invalid_argument(path + ": is there already");
    }
    if (descriptor < 0) {
        base::refuse_to_write(path, errno);
    }
    return descriptor;
}

}  // namespace

McapFile::OpenFile::OpenFile(const std::string& path, Existing existing) {
    const base::WriteTarget target = base::write_target(path);
    special = target.special;
    descriptor = open_to_write(path, target, existing == Existing::refused && !special);
    try {
        base::lock_for_writing(descriptor, path);  // before it is emptied: another process may be writing it
        if (!special && ::ftruncate(descriptor, 0) != 0) {
            base::refuse_to_write(path, errno);
        }
    } catch (...) {
        ::close(descriptor);
        throw;
    }
    if (!special) {
        sync_folder_of(target.path);
    }
}

McapFile::OpenFile::~OpenFile() {
    if (descriptor >= 0) {
        ::close(descriptor);
    }
}

McapFile::McapFile(const std::string& path, Existing existing, McapLayout layout)
    : path_(path),
      file_(path, existing),
      next_sync_(std::chrono::steady_clock::now() + sync_period),
      writer_([this](std::string_view bytes) { append(bytes); }, std::move(layout)) {}

std::uint16_t McapFile::add_schema(std::string_view name, std::string_view encoding, std::string_view text) {
    return writer_.add_schema(name, encoding, text);
}

std::uint16_t McapFile::add_channel(std::uint16_t schema, std::string_view topic, std::string_view encoding) {
    return writer_.add_channel(schema, topic, encoding);
}

void McapFile::append(std::string_view bytes) {
    if (const int error = base::write_all(file_.descriptor, std::as_bytes(std::span(bytes))); error != 0) {
        if (!file_.special) {
            // A part of a chunk is of no use to anybody; where it cannot be cut, readers stop before it.
            static_cast<void>(::ftruncate(file_.descriptor, static_cast<off_t>(size_)));
        }
        base::refuse_to_write(path_, error);
    }
    size_ += bytes.size();
    if (std::chrono::steady_clock::now() >= next_sync_) {
        sync();
        next_sync_ = std::chrono::steady_clock::now() + sync_period;
    }
}

/// Waits until the disk has all. EINVAL: a pipe, or a file system without such a call.
void McapFile::sync() {
    if (!file_.special && ::fdatasync(file_.descriptor) != 0 && errno != EINVAL) {
        base::refuse_to_write(path_, errno);
    }
}

void McapFile::finish() {
    writer_.finish();
    sync();
    if (::close(std::exchange(file_.descriptor, -1)) != 0) {
        base::refuse_to_write(path_, errno);
    }
}

}  // namespace disparityd::formats
