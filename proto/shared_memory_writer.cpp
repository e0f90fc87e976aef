// SPDX-License-Identifier: Apache-2.0
#include "proto/shared_memory_writer.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <new>
#include <stdexcept>

#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "proto/descriptor.h"
#include "proto/futex.h"
#include "proto/mapping.h"
#include "proto/monotonic_clock.h"
#include "proto/sequence_lock.h"

namespace disparityd::proto {
namespace {

/// An older sign of life counts as none.
constexpr std::int64_t fresh_ns = 3'000'000'000;

[[noreturn]] void refuse(const std::string& object, const std::string& what, int error) {
    throw std::runtime_error("shared memory " + object + ": " + what + ": " + std::strerror(error));
}

/// Linux keeps POSIX objects as files of this folder; that lets a finished object take its name in one step, so that
/// nobody ever meets a half-made one.
std::string path_of(const std::string& object) {
    return "/dev/shm" + object;
}

void tell_readers_the_end(ShmHeader& header) {
    header.generation.store(0, std::memory_order_release);
    header.published.fetch_add(1, std::memory_order_release);
    futex_wake_all(header.published);
}

bool process_lives(std::uint32_t pid) {
    return pid != 0 && pid <= 0x7fffffffU && (::kill(static_cast<pid_t>(pid), 0) == 0 || errno == EPERM);
}

/// What is there under the name already.
struct Predecessor {
    bool exists = false;
    std::uint32_t generation = 0;
    std::string note;
};

/// Its descriptor, -1 where there is none.
int open_predecessor(const std::string& object, bool& writable) {
    int fd = ::shm_open(object.c_str(), O_RDWR, 0);
    writable = fd >= 0;
    if (fd < 0 && errno == EACCES) {
        fd = ::shm_open(object.c_str(), O_RDONLY, 0);
    }
    if (fd < 0 && errno != ENOENT) {
        refuse(object, "it is there and cannot be opened (another user's? remove " + path_of(object) + ")", errno);
    }
    return fd;
}

/// Throws when a living daemon has it; otherwise says what will be replaced, and tells readers that still wait for its
/// frames.
Predecessor inspect(const std::string& object) {
    bool writable = false;
    const Descriptor file(open_predecessor(object, writable));
    if (file.get() < 0) {
        return {};
    }
    struct stat info {};
    if (::fstat(file.get(), &info) != 0) {
        refuse(object, "cannot be examined", errno);
    }
    const auto bytes = static_cast<std::uint64_t>(info.st_size);
    const std::string garbage = "replaced shared memory " + object + ", which ";
    if (bytes < sizeof(ShmHeader)) {
        return {true, 0, garbage + "was too small to be one of ours"};
    }
    const Mapping mapping(file, bytes, writable ? PROT_READ | PROT_WRITE : PROT_READ);
    if (!mapping) {
        refuse(object, "cannot be mapped", errno);
    }
    auto& header = mapping.start<ShmHeader>();
    ShmView view;
    if (const std::string wrong = check_header(header, bytes, view); !wrong.empty()) {
        return {true, 0, garbage + wrong};
    }
    const std::uint32_t pid = header.writer_pid.load(std::memory_order_relaxed);
    const std::uint32_t generation = header.generation.load(std::memory_order_acquire);
    const std::int64_t age = monotonic_ns() - header.heartbeat_ns.load(std::memory_order_acquire);
    if (generation != 0 && age >= 0 && age < fresh_ns && process_lives(pid)) {
        throw std::runtime_error("shared memory " + object + " is in use by process " + std::to_string(pid) +
                                 ": stop it or choose another name with [shared_memory] name");
    }
    if (writable) {
        tell_readers_the_end(header);
    }
    return {true, generation, "replaced shared memory " + object + ", left behind by process " + std::to_string(pid)};
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
    }
    lay_out(view);
    return view;
}

/// Reserves and maps the memory of a new object under a name of its own and fills in the header.
ShmHeader* make_object(const std::string& temporary, const std::string& object, const ShmView& view,
                       std::uint32_t generation) {
    ::shm_unlink(temporary.c_str());
    const Descriptor fd(::shm_open(temporary.c_str(), O_RDWR | O_CREAT | O_EXCL, 0600));
    if (fd.get() < 0) {
        refuse(object, "cannot be created", errno);
    }
    // Without reserving, a full /dev/shm would end the daemon with SIGBUS at its first frame.
    const int error = ::posix_fallocate(fd.get(), 0, static_cast<off_t>(view.total_bytes));
    if (error != 0) {
        ::shm_unlink(temporary.c_str());
        refuse(object, "cannot reserve " + std::to_string((view.total_bytes >> 20) + 1) + " MiB in /dev/shm", error);
    }
    void* memory = ::mmap(nullptr, view.total_bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, fd.get(), 0);
    if (memory == MAP_FAILED || ::fchmod(fd.get(), 0640) != 0) {
        const int saved = errno;
        ::shm_unlink(temporary.c_str());
        if (memory != MAP_FAILED) {
            ::munmap(memory, view.total_bytes);
        }
        refuse(object, "cannot be mapped", saved);
    }
    auto* header = new (memory) ShmHeader{};
    header->version = shm_version;
    header->header_bytes = sizeof(ShmHeader);
    header->total_bytes = view.total_bytes;
    header->slot_count = view.slot_count;
    header->plane_count = view.plane_count;
    header->slots_offset = view.slots_offset;
    header->slot_stride = view.slot_stride;
    header->payload_offset = view.payload_offset;
    header->width = view.width;
    header->height = view.height;
    std::copy(view.planes.begin(), view.planes.end(), header->planes);
    header->generation.store(generation, std::memory_order_relaxed);
    header->heartbeat_ns.store(monotonic_ns(), std::memory_order_relaxed);
    header->writer_pid.store(static_cast<std::uint32_t>(::getpid()), std::memory_order_relaxed);
    std::atomic_ref<std::uint64_t>(header->magic).store(shm_magic, std::memory_order_release);
    return header;
}

}  // namespace

SharedMemoryWriter::SharedMemoryWriter(const std::string& name, const ShmLayout& layout, std::uint32_t slot_count)
    : object_name_(shm_object_name(name)), slot_count_(slot_count) {
    create(layout);
}

SharedMemoryWriter::~SharedMemoryWriter() {
    close();
}

void SharedMemoryWriter::create(const ShmLayout& layout) {
    const ShmView view = view_of(layout, slot_count_);
    Predecessor found;
    if (header_ == nullptr) {
        found = inspect(object_name_);
    } else {
        found = {true, header_->generation.load(std::memory_order_relaxed), {}};
    }
    // 0 means closed, so it is left out; the clock makes it likely that a new object differs from a forgotten one.
    std::uint32_t generation =
        found.generation != 0 ? found.generation + 1 : static_cast<std::uint32_t>(monotonic_ns() / 1'000'000);
    generation += generation == 0 ? 1 : 0;

    const std::string temporary = object_name_ + "." + std::to_string(::getpid()) + ".new";
    ShmHeader* made = make_object(temporary, object_name_, view, generation);
    struct stat info {};
    const std::string from = path_of(temporary);
    const std::string to = path_of(object_name_);
    // link() does not replace: of two daemons that start at once, one is refused.
    const int result = found.exists ? ::rename(from.c_str(), to.c_str()) : ::link(from.c_str(), to.c_str());
    const int error = errno;
    if (!found.exists) {
        ::shm_unlink(temporary.c_str());
    }
    if (result != 0 || ::stat(to.c_str(), &info) != 0) {
        ::shm_unlink(temporary.c_str());
        ::munmap(made, view.total_bytes);
        refuse(object_name_, "cannot take the name " + to + " (if another user owns it, remove it)", error);
    }
    const std::lock_guard guard(mutex_);
    unmap();
    header_ = made;
    view_ = view;
    inode_ = info.st_ino;
    if (note_.empty()) {
        note_ = found.note;
    }
}

void SharedMemoryWriter::unmap() {
    if (header_ != nullptr) {
        tell_readers_the_end(*header_);
        ::munmap(header_, view_.total_bytes);
        header_ = nullptr;
    }
}

void SharedMemoryWriter::relayout(const ShmLayout& layout) {
    if (header_ == nullptr) {
        throw std::invalid_argument("shared memory " + object_name_ + " is closed");
    }
    create(layout);
}

void SharedMemoryWriter::close() {
    const std::lock_guard guard(mutex_);
    if (header_ == nullptr) {
        return;
    }
    struct stat info {};
    if (::stat(path_of(object_name_).c_str(), &info) == 0 && info.st_ino == inode_) {
        ::shm_unlink(object_name_.c_str());
    }
    unmap();
}

void SharedMemoryWriter::publish(const ShmFrame& frame, std::span<const PlaneSource> planes) {
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
        const std::size_t row = std::size_t{view_.width} * view_.planes[i].bytes_per_pixel;
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
        SharedPacker head(reinterpret_cast<std::uint64_t*>(&slot.frame));
        head.append(&frame, sizeof frame);
        for (std::uint32_t i = 0; i < view_.plane_count; ++i) {
            SharedPacker packer(const_cast<std::uint64_t*>(plane_words(slot, view_, view_.planes[i])));
            const auto* data = static_cast<const std::uint8_t*>(sources[i]->data);
            for (std::uint32_t y = 0; y < view_.height; ++y) {
                packer.append(data + y * sources[i]->stride, sources[i]->row_bytes);
            }
            packer.flush();
        }
    }
    header_->published_total.store(total + 1, std::memory_order_release);
    header_->published.fetch_add(1, std::memory_order_release);
}

void SharedMemoryWriter::wake() {
    const std::lock_guard guard(mutex_);
    if (header_ != nullptr) {
        futex_wake_all(header_->published);
    }
}

void SharedMemoryWriter::heartbeat() {
    const std::lock_guard guard(mutex_);
    if (header_ != nullptr) {
        header_->heartbeat_ns.store(monotonic_ns(), std::memory_order_release);
    }
}

}  // namespace disparityd::proto
