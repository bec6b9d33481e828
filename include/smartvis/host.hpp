/* SPDX-License-Identifier: MIT */
/*
 * A helper for hosts in C++17, header-only and optional. What a host has to give back
 * is given back by destructors, and a status below SV_OK is an exception:
 *
 *     smartvis::instance plugin(smartvis::library("/usr/lib/smartvis/smartvis.so"), "my host");
 *     smartvis::activation active(plugin, format);
 *     active.begin(frame);
 *     active.slab(slab);
 *     const sv_status outcome = active.end(result);
 *
 * An instance keeps its library loaded. An activation refers to its instance and must end before it does.
 * Threads are as the header says; the classes add no lock.
 */
#ifndef SMARTVIS_HOST_HPP
#define SMARTVIS_HOST_HPP

#include "smartvis/lookup.h"
#include "smartvis/open.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace smartvis {

/* A call that returned an error: its name and the plugin's reason. */
class error : public std::runtime_error {
  public:
    error(sv_status status, const std::string &what) : std::runtime_error(what), status_(status) {}
    sv_status status() const noexcept {
        return status_;
    }

  private:
    sv_status status_;
};

/* A struct of the ABI with its size set, and the rest 0. */
template <typename T> T sized() {
    T out{};
    out.size = static_cast<std::uint32_t>(sizeof out);
    return out;
}

/* Whether a renderer may use the map of a frame with this outcome; else it renders unclipped. */
constexpr bool clips(sv_status outcome) noexcept {
    return outcome == SV_OK || outcome == SV_PARTIAL;
}

/* A loaded library of plugins. Copies share it; the last one unloads it. */
class library {
  public:
    /* Throws std::runtime_error if the file is no library of plugins of this ABI's major version. */
    explicit library(const std::string &path) {
        char why[512];
        void *loaded = nullptr;
        entry_ = sv_open(path.c_str(), &loaded, why, sizeof why);
        if (!entry_) throw std::runtime_error(why);
        handle_.reset(loaded, sv_close);
        if (entry_->abi_major != SV_ABI_MAJOR)
            throw std::runtime_error(path + ": its ABI is " + std::to_string(entry_->abi_major) +
                                     ", expected " + std::to_string(SV_ABI_MAJOR));
    }

    const sv_entry &entry() const noexcept {
        return *entry_;
    }

    /* Plugin 0 .. entry().count - 1. Throws std::out_of_range for any other index. */
    const sv_descriptor &descriptor(std::uint32_t index = 0) const {
        const sv_descriptor *found = entry_->descriptor(index);
        if (!found) throw std::out_of_range("the library has no plugin " + std::to_string(index));
        return *found;
    }

  private:
    std::shared_ptr<void> handle_;
    const sv_entry *entry_ = nullptr;
};

/* One instance of a plugin, destroyed with this object. */
class instance {
  public:
    /* Called from any thread, with SV_LOG_* and a line of text. What it throws is dropped. */
    using log = std::function<void(std::int32_t severity, const char *text)>;

    /* The plugin with this id; NULL: the library's first. Throws error. */
    instance(library from, std::string host_name, log to = {}, const char *id = nullptr)
        : all_(std::make_unique<all>(std::move(from), std::move(host_name), std::move(to))) {
        if (!id) id = all_->from.descriptor().id;
        const sv_status status = all_->from.entry().create(&all_->host, id, &all_->plugin);
        if (status != SV_OK)
            throw error(status, std::string("create: ") + id + ": status " + std::to_string(status));
    }

    const sv_plugin *get() const noexcept {
        return all_->plugin;
    }
    const sv_plugin *operator->() const noexcept {
        return all_->plugin;
    }

    /* An extension's table: extension<sv_ext_confidence>(SV_EXT_CONFIDENCE). NULL: the plugin has none. */
    template <typename T> const T *extension(const char *id) const {
        return static_cast<const T *>(get()->get_extension(get(), id));
    }

    /* A value for the parameter with this key. Throws std::out_of_range if there is none. */
    sv_param_value value(const char *key, double value) const {
        sv_param_info info;
        if (!sv_lookup_key(get(), key, &info)) throw std::out_of_range(std::string("no parameter ") + key);
        return {info.id, 0, value};
    }

    /* Throws error for a status below SV_OK; else returns it. */
    sv_status check(const char *call, sv_status status) const {
        if (status < SV_OK) throw error(status, std::string(call) + ": " + get()->last_error(get()));
        return status;
    }

  private:
    /* At an address of its own, since the plugin keeps that of `host`. */
    struct all {
        all(library library_, std::string name_, log to_)
            : from(std::move(library_)), name(std::move(name_)), to(std::move(to_)), host(sized<sv_host>()) {
            host.abi_minor = SV_ABI_MINOR;
            host.host_data = this;
            host.name = host.version = name.c_str();
            host.log = [](const sv_host *host_, std::int32_t severity, const char *text) noexcept {
                try {
                    const all *self = static_cast<const all *>(host_->host_data);
                    if (self->to) self->to(severity, text);
                } catch (...) {
                }
            };
        }
        all(const all &) = delete;
        all &operator=(const all &) = delete;
        ~all() {
            if (plugin) plugin->destroy(plugin);
        }
        library from;
        std::string name;
        log to;
        sv_host host;
        const sv_plugin *plugin = nullptr;
    };
    std::unique_ptr<all> all_;
};

/* An instance between activate and deactivate. Every call throws error for a status below SV_OK. */
class activation {
  public:
    activation(const instance &plugin, const sv_format &format) : plugin_(plugin) {
        plugin.check("activate", plugin->activate(plugin.get(), &format));
    }
    activation(const activation &) = delete;
    activation &operator=(const activation &) = delete;
    ~activation() {
        plugin_->deactivate(plugin_.get());
    }

    void begin(const sv_frame &frame) {
        plugin_.check("begin", plugin_->begin(plugin_.get(), &frame));
    }
    void slab(const sv_slab &slab) {
        plugin_.check("slab", plugin_->slab(plugin_.get(), &slab));
    }

    /* With the plugin's own queue the outcome; with the host's SV_OK, and the outcome is in sv_stats. */
    sv_status end(const sv_result &result) {
        return plugin_.check("end", plugin_->end(plugin_.get(), &result));
    }
    sv_status adjust(const std::vector<sv_param_value> &values, const sv_result &result) {
        return plugin_.check("adjust", plugin_->adjust(plugin_.get(), values.data(),
                                                       static_cast<std::uint32_t>(values.size()), &result));
    }

  private:
    const instance &plugin_;
};

} // namespace smartvis

#endif
