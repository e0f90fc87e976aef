// SPDX-License-Identifier: Apache-2.0
#include "proto/shared_memory_writer.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <new>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include "proto/futex.h"
#include "proto/mapping.h"
#include "proto/monotonic_clock.h"
#include "proto/reader_lock.h"
#include "proto/sequence_lock.h"
#include "proto/shared_memory_owner.h"

namespace disparityd::proto {
namespace {

/// A daemon with an older heartbeat counts as dead.
constexpr std::int64_t fresh_ns = 3'000'000'000;

[[noreturn]] void refuse(const std::string& object, const std::string& what, int error) {
    throw std::runtime_error("shared memory " + object + ": " + what + ": " + std::strerror(error));
}

/// Linux keeps POSIX objects as files of this folder. A finished object can therefore take its name in one step, and no
/// reader opens an unfinished one.
std::string path_of(const std::string& object) {
    return "/dev/shm" + object;
}

void tell_readers_the_end(ShmHeader& header) {
    header.generation.store(0, std::memory_order_release);
    header.published.fetch_add(1, std::memory_order_release);
    futex_wake(header.published);
}

bool process_lives(std::uint32_t pid) {
    return pid != 0 && pid <= 0x7fffffffU && (::kill(static_cast<pid_t>(pid), 0) == 0 || errno == EPERM);
}

/// Describes the object that has the name already.
struct Predecessor {
    bool exists = false;
    std::uint32_t generation = 0;
    std::string note;
};

/// Returns a descriptor, or -1 and errno. Anything may have the name: the call follows no link and does not wait for a
/// pipe.
int open_predecessor(const std::string& object, bool& writable) {
    constexpr int careful = O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK;
    const int fd = ::shm_open(object.c_str(), O_RDWR | careful, 0);
    writable = fd >= 0;
    return fd < 0 && errno == EACCES ? ::shm_open(object.c_str(), O_RDONLY | careful, 0) : fd;
}

/// Wakes the readers that still wait for frames of a daemon that no longer runs.
void close_predecessor(const Descriptor& file, std::uint64_t bytes) {
    const Mapping mapping(file, bytes, PROT_READ | PROT_WRITE);
    if (mapping) {
        tell_readers_the_end(mapping.start<ShmHeader>());
    }
}

/// Returns what will be replaced. Throws when a running daemon has the name, or a user whose objects this process
/// cannot replace. Another user's object is never mapped: its owner could shrink it meanwhile.
Predecessor inspect(const std::string& object) {
    bool writable = false;
    const Descriptor file(open_predecessor(object, writable));
    struct stat info {};
    if (file.get() < 0 ? ::lstat(path_of(object).c_str(), &info) != 0 : ::fstat(file.get(), &info) != 0) {
        if (errno == ENOENT) {
            return {};
        }
        refuse(object, "cannot be examined", errno);
    }
    const bool ours = info.st_uid == ::geteuid();
    const std::string owner = ours ? "" : " of " + user_text(info.st_uid);
    ShmHeader header{};
    ShmView view;
    std::string wrong;
    if (!S_ISREG(info.st_mode)) {
        wrong = "was no plain file";
    } else if (::pread(file.get(), &header, sizeof header, 0) != static_cast<ssize_t>(sizeof header)) {
        wrong = "was too small to be one of ours, or not readable";
    } else {
        wrong = check_header(header, static_cast<std::uint64_t>(info.st_size), view);
    }
    const std::uint32_t pid = header.writer_pid.load(std::memory_order_relaxed);
    const std::uint32_t generation = header.generation.load(std::memory_order_relaxed);
    const std::int64_t age = monotonic_ns() - header.heartbeat_ns.load(std::memory_order_relaxed);
    if (wrong.empty() && generation != 0 && age >= 0 && age < fresh_ns && process_lives(pid)) {
        throw std::runtime_error("shared memory " + object + " is in use by process " + std::to_string(pid) + owner +
                                 ": stop it or choose another name with [shared_memory] name");
    }
    if (!ours && ::geteuid() != 0) {
        throw std::runtime_error("shared memory " + object + ": the name is taken by an object" + owner + ": remove " +
                                 path_of(object) +
                                 " as that user or root, or choose another name with [shared_memory] name");
    }
    const std::string replaced = "replaced shared memory " + object + owner + ", ";
    if (!wrong.empty()) {
        return {true, 0, replaced + "which " + wrong};
    }
    if (ours && writable && (info.st_mode & (S_IWGRP | S_IWOTH)) == 0) {
        close_predecessor(file, static_cast<std::uint64_t>(info.st_size));
    }
    return {true, generation, replaced + "left behind by process " + std::to_string(pid)};
}

ShmView view_of(const ShmLayout& layout, std::uint32_t slot_count) {
    if (layout.planes.size() > shm_max_planes) {
        throw std::invalid_argument("shared memory layout: " + std::to_string(layout.planes.size()) +
                                    " planes, allowed 0.." + std::to_string(shm_max_planes));
    }
    ShmView view;
    view.width = layout.width;
    view.height = layout.height;
    view.slot_count = slot_count;
    view.plane_count = static_cast<std::uint32_t>(layout.planes.size());
    for (std::size_t i = 0; i < layout.planes.size(); ++i) {
        view.planes[i].product = layout.planes[i].product;
        view.planes[i].bytes_per_pixel = layout.planes[i].bytes_per_pixel;
        view.planes[i].bytes = layout.planes[i].record_bytes;
    }
    lay_out(view);
    return view;
}

/// Returns a name that nobody can guess. Another user who knew it could take it first and keep the daemon from
/// starting.
std::string unguessable(const std::string& object) {
    std::array<std::uint8_t, 16> bytes{};
    if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
        refuse(object, "the system has no random numbers", errno);
    }
    std::string name = object + ".";
    for (const std::uint8_t byte : bytes) {
        constexpr const char* digits = "0123456789abcdef";
        name += {digits[byte >> 4], digits[byte & 15]};
    }
    return name + ".new";
}

/// Owns a new object under a temporary name. The destructor removes the name if it is still there.
class NewObject {
public:
    /// Creates the object, reserves and maps its memory, and fills its header in.
    NewObject(const std::string& object, const ShmView& view, std::uint32_t generation)
        : object_(object),
          bytes_(view.total_bytes),
          temporary_(unguessable(object)),
          file_(std::make_unique<const Descriptor>(
              ::shm_open(temporary_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600))) {
        if (file_->get() < 0) {
            refuse(object_, "cannot be created", errno);
        }
        try {
            reserve(*file_);
            fill(view, generation);
        } catch (...) {
            ::shm_unlink(temporary_.c_str());
            throw;
        }
    }
    ~NewObject() {
        ::shm_unlink(temporary_.c_str());
        if (memory_ != MAP_FAILED) {
            ::munmap(memory_, bytes_);
        }
    }
    NewObject(const NewObject&) = delete;
    NewObject& operator=(const NewObject&) = delete;

    /// Gives the object its name in one step. Without `replace` it fails where the name is taken: of two daemons that
    /// start at once, one is refused.
    void take_name(bool replace) {
        const std::string from = path_of(temporary_);
        const std::string to = path_of(object_);
        if ((replace ? ::rename(from.c_str(), to.c_str()) : ::link(from.c_str(), to.c_str())) != 0) {
            refuse(object_, "cannot take the name " + to, errno);
        }
    }

    const struct stat& info() const { return info_; }

    std::unique_ptr<const Descriptor> release_file() { return std::move(file_); }

    /// Gives the mapping to the caller.
    ShmHeader* release() { return static_cast<ShmHeader*>(std::exchange(memory_, MAP_FAILED)); }

private:
    void reserve(const Descriptor& file) {
        // Without this, a full /dev/shm would end the daemon with SIGBUS at its first frame.
        const int error = ::posix_fallocate(file.get(), 0, static_cast<off_t>(bytes_));
        if (error != 0) {
            refuse(object_, "cannot reserve " + std::to_string((bytes_ >> 20) + 1) + " MiB in /dev/shm", error);
        }
        memory_ = ::mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, file.get(), 0);
        if (memory_ == MAP_FAILED) {
            refuse(object_, "cannot be mapped", errno);
        }
        if (::fchmod(file.get(), 0640) != 0 || ::fstat(file.get(), &info_) != 0) {
            const int refused = errno;
            ::munmap(memory_, bytes_);
            refuse(object_, "cannot be made readable for the group", refused);
        }
    }

    void fill(const ShmView& view, std::uint32_t generation) {
        auto* header = new (memory_) ShmHeader{};
        const auto* const end = view.planes.begin() + view.plane_count;
        header->version = view.plane_count > shm_first_planes                ? shm_version_with_more_planes
                          : std::any_of(view.planes.begin(), end, is_record) ? shm_version_with_records
                                                                             : shm_version;
        header->header_bytes = sizeof(ShmHeader);
        header->total_bytes = view.total_bytes;
        header->slot_count = view.slot_count;
        header->plane_count = view.plane_count;
        header->slots_offset = view.slots_offset;
        header->slot_stride = view.slot_stride;
        header->payload_offset = view.payload_offset;
        header->width = view.width;
        header->height = view.height;
        for (std::size_t i = 0; i < view.planes.size(); ++i) {
            plane_at(*header, i) = view.planes[i];
        }
        header->generation.store(generation, std::memory_order_relaxed);
        header->heartbeat_ns.store(monotonic_ns(), std::memory_order_relaxed);
        header->writer_pid.store(static_cast<std::uint32_t>(::getpid()), std::memory_order_relaxed);
        std::atomic_ref<std::uint64_t>(header->magic).store(shm_magic, std::memory_order_release);
    }

    const std::string& object_;
    const std::size_t bytes_;
    const std::string temporary_;
    std::unique_ptr<const Descriptor> file_;
    void* memory_ = MAP_FAILED;
    struct stat info_ {};
};

}  // namespace

SharedMemoryWriter::SharedMemoryWriter(const std::string& name, const ShmLayout& layout, std::uint32_t slot_count)
    : object_name_(shm_object_name(name)), slot_count_(slot_count) {
    note_ = create(layout);
}

SharedMemoryWriter::~SharedMemoryWriter() {
    close();
}

bool SharedMemoryWriter::has_name() const {
    struct stat info {};
    return header_ != nullptr && ::lstat(path_of(object_name_).c_str(), &info) == 0 && info.st_ino == inode_ &&
           info.st_dev == device_;
}

std::string SharedMemoryWriter::create(const ShmLayout& layout) {
    const ShmView view = view_of(layout, slot_count_);
    const Predecessor found = has_name() ? Predecessor{true, 0, {}} : inspect(object_name_);
    const std::uint32_t before =
        header_ != nullptr ? header_->generation.load(std::memory_order_relaxed) : found.generation;
    // 0 means closed, so no object has it. The clock makes it likely that a new object differs from a removed one.
    std::uint32_t generation = before != 0 ? before + 1 : static_cast<std::uint32_t>(monotonic_ns() / 1'000'000);
    generation += generation == 0 ? 1 : 0;

    NewObject made(object_name_, view, generation);
    made.take_name(found.exists);
    ShmHeader* old = nullptr;
    std::uint64_t old_bytes = 0;
    {
        const std::lock_guard publishing(publishing_);
        const std::lock_guard guard(mutex_);
        old = std::exchange(header_, made.release());
        file_ = made.release_file();
        old_bytes = view_.total_bytes;
        view_ = view;
    }
    layout_ = layout;
    device_ = made.info().st_dev;
    inode_ = made.info().st_ino;
    if (old != nullptr) {
        tell_readers_the_end(*old);
        ::munmap(old, old_bytes);
    }
    return found.note;
}

void SharedMemoryWriter::relayout(const ShmLayout& layout, std::uint32_t slot_count) {
    if (header_ == nullptr) {
        throw std::invalid_argument("shared memory " + object_name_ + " is closed");
    }
    const std::uint32_t before = std::exchange(slot_count_, slot_count);
    try {
        create(layout);
    } catch (...) {
        slot_count_ = before;
        throw;
    }
}

void SharedMemoryWriter::restore() {
    if (header_ != nullptr && !has_name()) {
        create(ShmLayout(layout_));
    }
}

void SharedMemoryWriter::close() {
    if (has_name()) {
        ::shm_unlink(object_name_.c_str());
    }
    const std::lock_guard guard(mutex_);
    if (header_ != nullptr) {
        tell_readers_the_end(*header_);
        ::munmap(header_, view_.total_bytes);
        header_ = nullptr;
        file_.reset();
    }
}

void SharedMemoryWriter::publish(const FrameInfo& frame, std::span<const PlaneSource> planes, std::int64_t published_ns,
                                 bool outdated) {
    const std::lock_guard publishing(publishing_);
    if (header_ == nullptr) {
        throw std::invalid_argument("shared memory " + object_name_ + " is closed");
    }
    std::array<const PlaneSource*, shm_max_planes> sources{};
    for (std::uint32_t i = 0; i < view_.plane_count; ++i) {
        for (const PlaneSource& source : planes) {
            if (source.product == view_.planes[i].product) {
                sources[i] = &source;
            }
        }
        const PlaneShape shape = shape_of(view_, view_.planes[i]);
        const std::size_t row = std::size_t{shape.width} * shape.bytes_per_pixel;
        if (sources[i] == nullptr || sources[i]->data == nullptr || sources[i]->row_bytes != row ||
            sources[i]->stride < row) {
            throw std::invalid_argument("shared memory " + object_name_ + ": the plane of product " +
                                        std::to_string(view_.planes[i].product) +
                                        " is missing or has not the size of the layout");
        }
    }
    const std::uint64_t total = header_->published_total.load(std::memory_order_relaxed);
    auto& slot = const_cast<ShmSlot&>(slot_at(*header_, view_, total % view_.slot_count));
    {
        const WriteGuard inside(slot.lock);
        store_word(&slot.published_ns, static_cast<std::uint64_t>(published_ns));
        SharedPacker head(reinterpret_cast<std::uint64_t*>(&slot.frame));
        head.append(&frame, sizeof frame);
        for (std::uint32_t i = 0; i < view_.plane_count; ++i) {
            SharedPacker packer(const_cast<std::uint64_t*>(plane_words(slot, view_, view_.planes[i])));
            const auto* data = static_cast<const std::uint8_t*>(sources[i]->data);
            const std::uint32_t rows = shape_of(view_, view_.planes[i]).height;
            for (std::uint32_t y = 0; y < rows; ++y) {
                packer.append(data + y * sources[i]->stride, sources[i]->row_bytes);
            }
            packer.flush();
        }
    }
    if (outdated) {  // before any reader can see it
        header_->outdated_total.store(total + 1, std::memory_order_release);
    }
    header_->published_total.store(total + 1, std::memory_order_release);
    header_->published.fetch_add(1, std::memory_order_release);
}

int SharedMemoryWriter::wake(int most) {
    const std::lock_guard guard(mutex_);
    return header_ == nullptr ? 0 : futex_wake(header_->published, most);
}

void SharedMemoryWriter::heartbeat() {
    const std::lock_guard guard(mutex_);
    if (header_ != nullptr) {
        header_->heartbeat_ns.store(monotonic_ns(), std::memory_order_release);
    }
}

bool SharedMemoryWriter::has_reader() {
    const std::lock_guard guard(mutex_);
    return file_ && has_reader_lock(*file_);
}

void SharedMemoryWriter::outdate() {
    const std::lock_guard guard(mutex_);
    if (header_ != nullptr) {
        header_->outdated_total.store(header_->published_total.load(std::memory_order_acquire),
                                      std::memory_order_release);
    }
}

}  // namespace disparityd::proto
