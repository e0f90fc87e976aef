// SPDX-License-Identifier: Apache-2.0
#include "tests/bridges/ros2/fast_subscriber.h"

#include <condition_variable>
#include <map>
#include <mutex>
#include <stdexcept>
#include <utility>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

#include "formats/cdr_reader.h"

namespace disparityd::test {
namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

std::int64_t now_ns() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
        .count();
}

/// A type whose messages stay bytes.
class Bytes : public dds::TopicDataType {
public:
    explicit Bytes(const std::string& name) {
        setName(name.c_str());
        m_typeSize = 16 << 20;
        m_isGetKeyDefined = false;
        auto_fill_type_information(false);
        auto_fill_type_object(false);
    }
    bool serialize(void* /*data*/, rtps::SerializedPayload_t* /*payload*/) override { return false; }
    bool deserialize(rtps::SerializedPayload_t* payload, void* data) override {
        static_cast<std::string*>(data)->assign(reinterpret_cast<const char*>(payload->data), payload->length);
        return true;
    }
    std::function<std::uint32_t()> getSerializedSizeProvider(void* /*data*/) override {
        return [] { return 0U; };
    }
    void* createData() override { return new std::string; }
    void deleteData(void* data) override { delete static_cast<std::string*>(data); }
    bool getKey(void* /*data*/, rtps::InstanceHandle_t* /*handle*/, bool /*force_md5*/) override { return false; }
};

rtps::Locator_t loopback(std::uint32_t port) {
    rtps::Locator_t locator;
    rtps::IPLocator::setIPv4(locator, "127.0.0.1");
    locator.port = port;
    return locator;
}

dds::DomainParticipantQos participant_qos(std::uint32_t domain, bool own_buffers) {
    dds::DomainParticipantQos qos;
    auto transport = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    transport->interfaceWhiteList.emplace_back("127.0.0.1");
    if (own_buffers) {
        transport->receiveBufferSize = 4 << 20;
        qos.transport().listen_socket_buffer_size = 4 << 20;
    }
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports.push_back(transport);
    // Where participants 0 to 9 of the domain listen: there need not be multicast.
    for (std::uint32_t index = 0; index < 10; ++index) {
        qos.wire_protocol().builtin.initialPeersList.push_back(loopback(7400 + 250 * domain + 10 + 2 * index));
    }
    qos.wire_protocol().builtin.metatrafficUnicastLocatorList.push_back(loopback(0));
    qos.wire_protocol().builtin.discovery_config.leaseDuration_announcementperiod = {1, 0};
    qos.wire_protocol().builtin.discovery_config.leaseDuration = {10, 0};
    const std::string enclave = "enclave=/;";
    qos.user_data().data_vec({enclave.begin(), enclave.end()});
    return qos;
}

}  // namespace

std::int64_t stamp_of(const FastMessage& message) {
    formats::CdrReader cdr({reinterpret_cast<const std::uint8_t*>(message.bytes.data()), message.bytes.size()});
    const auto seconds = cdr.get<std::int32_t>();
    return seconds * std::int64_t{1'000'000'000} + cdr.get<std::uint32_t>();
}

class FastSubscriber::Impl : public dds::DomainParticipantListener {
public:
    struct Subscription : dds::DataReaderListener {
        Impl* owner = nullptr;
        dds::Topic* topic = nullptr;
        dds::DataReader* reader = nullptr;
        int writers = 0;
        std::vector<FastMessage> messages;

        void on_data_available(dds::DataReader* from) override {
            FastMessage message;
            dds::SampleInfo info;
            while (from->take_next_sample(&message.bytes, &info) ==
                   eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK) {
                message.arrived_ns = now_ns();
                message.source_ns = info.source_timestamp.to_ns();
                if (info.valid_data) {
                    const std::lock_guard lock(owner->mutex_);
                    messages.push_back(message);
                    owner->changed_.notify_all();
                }
            }
        }
        void on_subscription_matched(dds::DataReader* /*reader*/,
                                     const dds::SubscriptionMatchedStatus& status) override {
            const std::lock_guard lock(owner->mutex_);
            writers = status.current_count;
            owner->changed_.notify_all();
        }
    };

    Impl(std::uint32_t domain, bool own_buffers) {
        participant_ = dds::DomainParticipantFactory::get_instance()->create_participant(
            domain, participant_qos(domain, own_buffers), this, dds::StatusMask::none());
        if (participant_ == nullptr) {
            throw std::runtime_error("Fast DDS makes no participant");
        }
        subscriber_ = participant_->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
    }
    ~Impl() override {
        for (auto& [topic, subscription] : subscriptions_) {
            end(*subscription);
        }
        participant_->set_listener(nullptr);
        participant_->delete_contained_entities();
        dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
    }
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;

    void on_participant_discovery(dds::DomainParticipant* /*participant*/,
                                  rtps::ParticipantDiscoveryInfo&& info) override {
        if (info.status == rtps::ParticipantDiscoveryInfo::DISCOVERED_PARTICIPANT) {
            const std::lock_guard lock(mutex_);
            participants_.emplace_back(info.info.m_userData.begin(), info.info.m_userData.end());
            changed_.notify_all();
        }
    }
    void on_publisher_discovery(dds::DomainParticipant* /*participant*/, rtps::WriterDiscoveryInfo&& info) override {
        const std::lock_guard lock(mutex_);
        const auto& data = info.info.m_qos.m_userData;
        user_data_[info.info.topicName().c_str()] = std::string(data.begin(), data.end());
        changed_.notify_all();
    }

    void subscribe(const std::string& topic, const std::string& type, const FastQuality& quality) {
        dds::TypeSupport(new Bytes(type)).register_type(participant_);
        auto made = std::make_unique<Subscription>();
        made->owner = this;
        made->topic = participant_->create_topic(topic, type, dds::TOPIC_QOS_DEFAULT);
        dds::DataReaderQos qos = dds::DATAREADER_QOS_DEFAULT;
        qos.reliability().kind = quality.reliable ? dds::RELIABLE_RELIABILITY_QOS : dds::BEST_EFFORT_RELIABILITY_QOS;
        qos.durability().kind =
            quality.transient_local ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
        qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
        qos.history().depth = quality.depth;
        qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
        Subscription& kept = *made;
        {
            const std::lock_guard lock(mutex_);
            subscriptions_[topic] = std::move(made);
        }
        dds::DataReader* const reader = subscriber_->create_datareader(kept.topic, qos, &kept);
        if (reader == nullptr) {
            throw std::runtime_error("Fast DDS makes no reader of " + topic);
        }
        const std::lock_guard lock(mutex_);
        kept.reader = reader;
    }

    void end(Subscription& subscription) {
        subscription.reader->set_listener(nullptr);
        subscriber_->delete_datareader(subscription.reader);
        participant_->delete_topic(subscription.topic);
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    dds::DomainParticipant* participant_ = nullptr;
    dds::Subscriber* subscriber_ = nullptr;
    std::map<std::string, std::unique_ptr<Subscription>> subscriptions_;
    std::map<std::string, std::string> user_data_;
    std::vector<std::string> participants_;
};

FastSubscriber::FastSubscriber(std::uint32_t domain, bool own_buffers)
    : impl_(std::make_unique<Impl>(domain, own_buffers)) {}

FastSubscriber::~FastSubscriber() = default;

void FastSubscriber::subscribe(const std::string& topic, const std::string& type, const FastQuality& quality) {
    impl_->subscribe(topic, type, quality);
}

void FastSubscriber::unsubscribe(const std::string& topic) {
    std::unique_ptr<Impl::Subscription> gone;
    {
        const std::lock_guard lock(impl_->mutex_);
        gone = std::move(impl_->subscriptions_.at(topic));
        impl_->subscriptions_.erase(topic);
    }
    impl_->end(*gone);
}

int FastSubscriber::writers(const std::string& topic) {
    const std::lock_guard lock(impl_->mutex_);
    return impl_->subscriptions_.at(topic)->writers;
}

std::string FastSubscriber::user_data(const std::string& topic) {
    const std::lock_guard lock(impl_->mutex_);
    const auto found = impl_->user_data_.find(topic);
    return found == impl_->user_data_.end() ? std::string() : found->second;
}

std::vector<std::string> FastSubscriber::participants() {
    const std::lock_guard lock(impl_->mutex_);
    return impl_->participants_;
}

std::vector<FastMessage> FastSubscriber::take(const std::string& topic) {
    const std::lock_guard lock(impl_->mutex_);
    return std::exchange(impl_->subscriptions_.at(topic)->messages, {});
}

bool FastSubscriber::wait(const std::function<bool()>& done, std::chrono::seconds most) {
    const auto end = std::chrono::steady_clock::now() + most;
    while (!done()) {
        std::unique_lock lock(impl_->mutex_);
        // What came between the question and here is asked for again soon.
        impl_->changed_.wait_until(lock,
                                   std::min(end, std::chrono::steady_clock::now() + std::chrono::milliseconds(50)));
        if (std::chrono::steady_clock::now() >= end) {
            lock.unlock();
            return done();
        }
    }
    return true;
}

}  // namespace disparityd::test
