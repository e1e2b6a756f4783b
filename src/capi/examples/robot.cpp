// A robot feels a bar of radius 25: touches in, what it is out. Built by CMake (CMakeLists.txt beside it), or as
//
//     c++ -std=c++17 -I include examples/robot.cpp -L ../../target/release -lpalpate_capi -o robot

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <palpate.hpp>

// The bar lies along y; its top is at z = 0. Errors are a fixed pattern, so that every run prints the same.
static void touch(int k, palpate::Vector &place, palpate::Vector &normal) {
    const double x = 3.0 * (k % 5) - 6.0, y = 2.0 * (k / 5) - 6.0;
    const double up = std::sqrt(625.0 - x * x);
    place = {x, y, up - 25.0 + 0.02 * std::sin(2.3 * k)};
    normal = {x / 25.0 + 0.01 * std::sin(1.7 * k), 0.01 * std::sin(3.1 * k), up / 25.0};
}

int main() {
    palpate::Vector place, normal;
    palpate::Contacts contacts;
    for (int k = 0; k < 35; k++) {
        touch(k, place, normal);
        contacts.add(place, normal);
    }

    // which shape it is, when no model is named
    const palpate::Recognition found(contacts);
    const palpate::Shape shape = found.shape();
    std::printf("%s, a %s: radius %.2f [%.2f, %.2f], S %.3f, R %.4f of %zu contacts\n", palpate_class_name(shape.class_),
                palpate_kind_name(shape.kind), shape.radius.mean, shape.radius.lo, shape.radius.hi, shape.shape_index.mean,
                shape.curvedness.mean, shape.contacts);
    std::printf("distance of the top: %.2f; points of the map: %zu\n", found.distance({0, 0, 0}), found.map().size());

    // the same under a spline that is named
    const palpate::Fit fit(contacts);
    std::printf("height field: %s, height at the top %.2f, R there %.4f\n", palpate_class_name(fit.shape().class_),
                fit.at(0, 0).z, fit.at(0, 0).curvedness);

    // touch by touch, as a control loop does
    PalpateStreamOptions plan = palpate::stream_defaults();
    const double domain[4] = {-6, 6, -6, 8};
    std::copy(domain, domain + 4, plan.domain);
    plan.sigma[0] = 0.02;
    plan.sigma[1] = plan.sigma[2] = 0.02;
    plan.window = 30;
    palpate::Stream stream(plan);
    for (int k = 0; k < 35; k++) {
        touch(k, place, normal);
        stream.push(place, normal);
    }
    if (const auto now = stream.shape()) {
        std::printf("stream: S %.3f +- %.3f, R %.4f +- %.4f of the last %zu\n", now->shape_index.mean, now->shape_index.u,
                    now->curvedness.mean, now->curvedness.u, now->contacts);
    }

    // what is refused says why
    try {
        stream.push({100, 0, 0}, 0, 0);
    } catch (const palpate::Error &error) {
        std::printf("refused (%d): %s\n", error.status(), error.what());
    }
    return 0;
}
