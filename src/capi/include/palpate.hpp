/* palpate for C++17: handles that free themselves, and errors that are thrown.
 *
 *     palpate::Contacts contacts;
 *     contacts.add({0, 0, 1}, {0, 0, 1});
 *     palpate::Recognition found(contacts);
 *     found.shape().radius.mean
 */
#ifndef PALPATE_HPP
#define PALPATE_HPP

#include "palpate.h"

#include <array>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace palpate {

using Vector = std::array<double, 3>;
using Shape = PalpateShape;
using MapPoint = PalpateMapPoint;
using Point = PalpatePoint;
using StreamShape = PalpateStreamShape;

/// Why a call was refused.
class Error : public std::runtime_error {
public:
    Error(PalpateStatus status, const char *message) : std::runtime_error(message), status_(status) {}
    PalpateStatus status() const noexcept { return status_; }

private:
    PalpateStatus status_;
};

/// Throws what a call was refused for.
inline void check(PalpateStatus status) {
    if (status != PALPATE_STATUS_OK) throw Error(status, palpate_last_message());
}

inline std::string name_of(PalpateClass which) { return palpate_class_name(which); }
inline std::string name_of(PalpateKind which) { return palpate_kind_name(which); }

inline PalpateRecogniseOptions recognise_defaults() {
    PalpateRecogniseOptions options{};
    check(palpate_recognise_defaults(&options));
    return options;
}

inline PalpateFitOptions fit_defaults() {
    PalpateFitOptions options{};
    check(palpate_fit_defaults(&options));
    return options;
}

inline PalpateStreamOptions stream_defaults() {
    PalpateStreamOptions options{};
    check(palpate_stream_defaults(&options));
    return options;
}

/// Places that were touched, each with or without its normal.
class Contacts {
public:
    Contacts() {
        PalpateContacts *made = nullptr;
        check(palpate_contacts_new(&made));
        handle_.reset(made);
    }
    void add(const Vector &p) { check(palpate_contacts_add(handle_.get(), p[0], p[1], p[2])); }
    void add(const Vector &p, const Vector &n) {
        check(palpate_contacts_add_with_normal(handle_.get(), p[0], p[1], p[2], n[0], n[1], n[2]));
    }
    void clear() { check(palpate_contacts_clear(handle_.get())); }
    std::size_t size() const { return palpate_contacts_count(handle_.get()); }
    const PalpateContacts *get() const { return handle_.get(); }

private:
    struct Free {
        void operator()(PalpateContacts *handle) const { palpate_contacts_free(handle); }
    };
    std::unique_ptr<PalpateContacts, Free> handle_;
};

/// Which shape contacts show, when no model is named.
class Recognition {
public:
    explicit Recognition(const Contacts &contacts, const PalpateRecogniseOptions &options = recognise_defaults()) {
        PalpateRecognition *made = nullptr;
        check(palpate_recognise(contacts.get(), &options, &made));
        handle_.reset(made);
    }
    Shape shape() const {
        Shape shape;
        check(palpate_recognition_shape(handle_.get(), &shape));
        return shape;
    }
    std::vector<MapPoint> map() const {
        std::size_t count = 0;
        check(palpate_recognition_map(handle_.get(), nullptr, 0, &count));
        std::vector<MapPoint> points(count);
        check(palpate_recognition_map(handle_.get(), points.data(), points.size(), &count));
        return points;
    }
    /// Signed distance of a place, positive on the free side.
    double distance(const Vector &p) const {
        double distance = 0;
        check(palpate_recognition_distance(handle_.get(), p[0], p[1], p[2], &distance));
        return distance;
    }

private:
    struct Free {
        void operator()(PalpateRecognition *handle) const { palpate_recognition_free(handle); }
    };
    std::unique_ptr<PalpateRecognition, Free> handle_;
};

/// The fit of a spline that is named.
class Fit {
public:
    explicit Fit(const Contacts &contacts, const PalpateFitOptions &options = fit_defaults()) {
        PalpateFit *made = nullptr;
        check(palpate_fit(contacts.get(), &options, &made));
        handle_.reset(made);
    }
    Shape shape() const {
        Shape shape;
        check(palpate_fit_shape(handle_.get(), &shape));
        return shape;
    }
    Point at(double x, double y) const {
        Point point;
        check(palpate_fit_at(handle_.get(), x, y, &point));
        return point;
    }
    std::vector<MapPoint> map() const {
        std::size_t count = 0;
        check(palpate_fit_map(handle_.get(), nullptr, 0, &count));
        std::vector<MapPoint> points(count);
        check(palpate_fit_map(handle_.get(), points.data(), points.size(), &count));
        return points;
    }

private:
    struct Free {
        void operator()(PalpateFit *handle) const { palpate_fit_free(handle); }
    };
    std::unique_ptr<PalpateFit, Free> handle_;
};

/// Touches one by one. Neither push nor shape asks for memory on patches of one segment.
class Stream {
public:
    explicit Stream(const PalpateStreamOptions &options) {
        PalpateStream *made = nullptr;
        check(palpate_stream_new(&options, &made));
        handle_.reset(made);
    }
    void push(const Vector &p, const Vector &n) {
        check(palpate_stream_push_with_normal(handle_.get(), p[0], p[1], p[2], n[0], n[1], n[2]));
    }
    void push(const Vector &p, double zx, double zy) { check(palpate_stream_push(handle_.get(), p[0], p[1], p[2], zx, zy)); }
    /// Nothing while the touches are too few.
    std::optional<StreamShape> shape() {
        StreamShape shape;
        const PalpateStatus status = palpate_stream_shape(handle_.get(), &shape);
        if (status == PALPATE_STATUS_NO_ANSWER) return std::nullopt;
        check(status);
        return shape;
    }
    void clear() { check(palpate_stream_clear(handle_.get())); }
    std::size_t size() const { return palpate_stream_count(handle_.get()); }

private:
    struct Free {
        void operator()(PalpateStream *handle) const { palpate_stream_free(handle); }
    };
    std::unique_ptr<PalpateStream, Free> handle_;
};

}  // namespace palpate

#endif
