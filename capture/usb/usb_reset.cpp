// SPDX-License-Identifier: Apache-2.0
#include "capture/usb/usb_reset.h"

#include <cerrno>
#include <memory>

#include <libusb.h>

namespace disparityd::capture {

namespace {

int to_errno(int code) {
    switch (code) {
        case LIBUSB_SUCCESS:
        case LIBUSB_ERROR_NOT_FOUND: return 0;  // it came back under another address: that is what a reset may do
        case LIBUSB_ERROR_NO_DEVICE: return ENODEV;
        case LIBUSB_ERROR_ACCESS: return EACCES;
        case LIBUSB_ERROR_BUSY: return EBUSY;
        case LIBUSB_ERROR_TIMEOUT: return ETIMEDOUT;
        case LIBUSB_ERROR_NO_MEM: return ENOMEM;
        case LIBUSB_ERROR_NOT_SUPPORTED: return ENOTSUP;
        default: return EIO;
    }
}

struct FreeContext {
    void operator()(libusb_context* context) const { libusb_exit(context); }
};

struct FreeList {
    void operator()(libusb_device** list) const { libusb_free_device_list(list, 1); }
};

int reset(libusb_device* device) {
    libusb_device_handle* handle = nullptr;
    if (const int opened = libusb_open(device, &handle); opened != LIBUSB_SUCCESS) {
        return to_errno(opened);
    }
    const int done = libusb_reset_device(handle);
    libusb_close(handle);
    return to_errno(done);
}

}  // namespace

int reset_usb_device(int bus, int address) {
    libusb_context* made = nullptr;
    if (const int started = libusb_init(&made); started != LIBUSB_SUCCESS) {
        return to_errno(started);
    }
    const std::unique_ptr<libusb_context, FreeContext> context(made);
    libusb_device** found = nullptr;
    const auto count = libusb_get_device_list(context.get(), &found);
    if (count < 0) {
        return to_errno(static_cast<int>(count));
    }
    const std::unique_ptr<libusb_device*, FreeList> list(found);
    for (ssize_t i = 0; i < count; ++i) {
        if (libusb_get_bus_number(found[i]) == bus && libusb_get_device_address(found[i]) == address) {
            return reset(found[i]);
        }
    }
    return ENODEV;
}

}  // namespace disparityd::capture
