#pragma once

#include <memory>
#include <utility>

namespace slalom {

/// Owns an object of a class that derives from `T`, or nothing. A copy owns a copy of the object, made by its
/// function `std::unique_ptr<T> clone() const`. C++26 has `std::polymorphic` for this.
template <class T>
class Polymorphic {
 public:
  Polymorphic() = default;
  /// Takes over an object.
  Polymorphic(std::unique_ptr<T> object) noexcept : object_(std::move(object)) {}
  Polymorphic(const Polymorphic& other) : object_(other.object_ ? other.object_->clone() : nullptr) {}
  Polymorphic(Polymorphic&&) noexcept = default;
  Polymorphic& operator=(const Polymorphic& other) { return *this = Polymorphic(other); }
  Polymorphic& operator=(Polymorphic&&) noexcept = default;
  ~Polymorphic() = default;

  T& operator*() noexcept { return *object_; }                    ///< the object
  const T& operator*() const noexcept { return *object_; }        ///< the object
  T* operator->() noexcept { return object_.get(); }              ///< the object
  const T* operator->() const noexcept { return object_.get(); }  ///< the object
  T* get() noexcept { return object_.get(); }                     ///< the object, or null
  const T* get() const noexcept { return object_.get(); }         ///< the object, or null

 private:
  std::unique_ptr<T> object_;
};

}  // namespace slalom
