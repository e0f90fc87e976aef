// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros2/cdr_topic.h"

#include <cstring>
#include <memory>
#include <new>
#include <utility>

#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>

// What Cyclone DDS asks for of a type, in its words: a "sertype" stands for a type, a "serdata" for a message in bytes.
// There are writers alone, so whatever is for readers has nothing to do.
namespace disparityd::ros2 {
namespace {

/// DDS asks for whole words of 4 bytes.
constexpr std::size_t word = 4;

struct Message {
    std::shared_ptr<const std::string> words;  ///< with zeros up to a whole word
    std::size_t size = 0;                      ///< of the message itself
};

struct Serdata : ddsi_serdata {
    Message message;
};

const Serdata& of(const ddsi_serdata* data) {
    return *static_cast<const Serdata*>(data);
}

bool same_key(const ddsi_serdata* /*one*/, const ddsi_serdata* /*other*/) {
    return true;
}

std::uint32_t size_of(const ddsi_serdata* data) {
    return static_cast<std::uint32_t>(of(data).message.size);
}

ddsi_serdata* make(const ddsi_sertype* type, ddsi_serdata_kind kind, Message message) {
    auto* const made = new (std::nothrow) Serdata;
    if (made != nullptr) {
        ddsi_serdata_init(made, type, kind);
        made->message = std::move(message);
    }
    return made;
}

ddsi_serdata* from_network(const ddsi_sertype* /*type*/, ddsi_serdata_kind /*kind*/, const nn_rdata* /*fragments*/,
                           std::size_t /*size*/) {
    return nullptr;
}

ddsi_serdata* from_parts(const ddsi_sertype* /*type*/, ddsi_serdata_kind /*kind*/, ddsrt_msg_iovlen_t /*count*/,
                         const ddsrt_iovec_t* /*parts*/, std::size_t /*size*/) {
    return nullptr;
}

ddsi_serdata* from_keyhash(const ddsi_sertype* type, const ddsi_keyhash* /*hash*/) {
    return make(type, SDK_KEY, {});
}

ddsi_serdata* from_sample(const ddsi_sertype* type, ddsi_serdata_kind kind, const void* sample) {
    return make(type, kind, kind == SDK_DATA ? *static_cast<const Message*>(sample) : Message{});
}

void to_bytes(const ddsi_serdata* data, std::size_t offset, std::size_t size, void* to) {
    std::memcpy(to, of(data).message.words->data() + offset, size);
}

ddsi_serdata* lend_bytes(const ddsi_serdata* data, std::size_t offset, std::size_t size, ddsrt_iovec_t* lent) {
    lent->iov_base = const_cast<char*>(of(data).message.words->data()) + offset;
    lent->iov_len = size;
    return ddsi_serdata_ref(data);
}

void give_back(ddsi_serdata* data, const ddsrt_iovec_t* /*lent*/) {
    ddsi_serdata_unref(data);
}

bool to_sample(const ddsi_serdata* /*data*/, void* /*sample*/, void** /*buffer*/, void* /*limit*/) {
    return false;
}

ddsi_serdata* to_untyped(const ddsi_serdata* data) {
    ddsi_serdata* const made = make(data->type, SDK_KEY, {});
    if (made != nullptr) {
        made->type = nullptr;
    }
    return made;
}

bool untyped_to_sample(const ddsi_sertype* /*type*/, const ddsi_serdata* /*data*/, void* /*sample*/, void** /*buffer*/,
                       void* /*limit*/) {
    return true;
}

void free_serdata(ddsi_serdata* data) {
    delete static_cast<Serdata*>(data);
}

std::size_t print(const ddsi_sertype* /*type*/, const ddsi_serdata* /*data*/, char* to, std::size_t size) {
    if (size > 0) {
        *to = '\0';
    }
    return 0;
}

void keyhash_of(const ddsi_serdata* /*data*/, ddsi_keyhash* hash, bool /*force_md5*/) {
    std::memset(hash, 0, sizeof *hash);
}

ddsi_serdata_ops make_serdata_operations() {
    ddsi_serdata_ops made{};
    made.eqkey = same_key;
    made.get_size = size_of;
    made.from_ser = from_network;
    made.from_ser_iov = from_parts;
    made.from_keyhash = from_keyhash;
    made.from_sample = from_sample;
    made.to_ser = to_bytes;
    made.to_ser_ref = lend_bytes;
    made.to_ser_unref = give_back;
    made.to_sample = to_sample;
    made.to_untyped = to_untyped;
    made.untyped_to_sample = untyped_to_sample;
    made.free = free_serdata;
    made.print = print;
    made.get_keyhash = keyhash_of;
    return made;
}

void free_sertype(ddsi_sertype* type) {
    ddsi_sertype_fini(type);
    delete type;
}

bool same_type(const ddsi_sertype* /*one*/, const ddsi_sertype* /*other*/) {
    return true;  // the names are the same already
}

std::uint32_t hash_of(const ddsi_sertype* /*type*/) {
    return 0;
}

void zero_samples(const ddsi_sertype* /*type*/, void* /*samples*/, std::size_t /*count*/) {}

void realloc_samples(void** /*samples*/, const ddsi_sertype* /*type*/, void* /*old*/, std::size_t /*old_count*/,
                     std::size_t /*count*/) {}

void free_samples(const ddsi_sertype* /*type*/, void** /*samples*/, std::size_t /*count*/, dds_free_op_t /*what*/) {}

ddsi_sertype_ops make_sertype_operations() {
    ddsi_sertype_ops made{};
    made.version = ddsi_sertype_v0;
    made.free = free_sertype;
    made.zero_samples = zero_samples;
    made.realloc_samples = realloc_samples;
    made.free_samples = free_samples;
    made.equal = same_type;
    made.hash = hash_of;
    return made;
}

}  // namespace

dds_entity_t create_cdr_topic(dds_entity_t participant, const std::string& name, const std::string& type_name) {
    // DDS keeps their addresses for as long as the library is there.
    static const ddsi_serdata_ops serdata_operations = make_serdata_operations();
    static const ddsi_sertype_ops sertype_operations = make_sertype_operations();
    auto* type = new ddsi_sertype{};
    ddsi_sertype_init(type, type_name.c_str(), &sertype_operations, &serdata_operations, true);
    type->allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1;
    const dds_entity_t topic = dds_create_topic_sertype(participant, name.c_str(), &type, nullptr, nullptr, nullptr);
    if (topic < 0) {
        ddsi_sertype_unref(type);
    }
    return topic;
}

dds_return_t write_cdr(dds_entity_t writer, std::string message) {
    const std::size_t size = message.size();
    message.resize((size + word - 1) / word * word);
    const Message sample{std::make_shared<const std::string>(std::move(message)), size};
    return dds_write(writer, &sample);
}

}  // namespace disparityd::ros2
