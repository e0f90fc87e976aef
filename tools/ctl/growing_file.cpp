// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/growing_file.h"

#include <cerrno>
#include <filesystem>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file_lock.h"
#include "base/write_failure.h"
#include "base/write_target.h"

namespace disparityd::tools {

std::string GrowingFile::part_of(const std::string& path) {
    const std::filesystem::path whole(path);
    return (whole.parent_path() / ('.' + whole.filename().string() + ".part")).string();
}

GrowingFile::GrowingFile(const std::string& path) {
    const base::WriteTarget target = base::write_target(path);
    path_ = target.path;
    part_ = target.special ? path_ : part_of(path_);
    const int descriptor = ::open(part_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    file_.reset(descriptor < 0 ? nullptr : ::fdopen(descriptor, "w"));
    if (!file_) {
        base::refuse_to_write(path, errno);
    }
    base::lock_for_writing(descriptor, path);       // before it is emptied: another process may be writing it
    static_cast<void>(::ftruncate(descriptor, 0));  // a pipe or a device has no length
    if (target.mode) {
        ::fchmod(descriptor, *target.mode);
    }
}

void GrowingFile::write(std::string_view text) {
    if (std::fwrite(text.data(), 1, text.size(), file_.get()) != text.size()) {
        base::refuse_to_write(path_, errno);
    }
}

void GrowingFile::flush() {
    if (std::fflush(file_.get()) != 0) {
        base::refuse_to_write(path_, errno);
    }
}

void GrowingFile::finish() {
    flush();
    // A power cut must not leave the name without the content. EINVAL: the file system has no such call.
    if (part_ != path_ && ::fsync(::fileno(file_.get())) != 0 && errno != EINVAL) {
        base::refuse_to_write(path_, errno);
    }
    // Renamed while it is open, and locked: nobody else may have begun another one of that name.
    if (part_ != path_ && ::rename(part_.c_str(), path_.c_str()) != 0) {
        base::refuse_to_write(path_, errno);
    }
    if (std::fclose(file_.release()) != 0) {
        base::refuse_to_write(path_, errno);
    }
}

}  // namespace disparityd::tools
