// Reads a project of Natron with Boost's reader, which Natron uses, and prints what is in it.
//
// Classes, their versions and the order of their elements are those of Natron 2.3, from the `…Serialization.h` in the folder
// `Engine` of its public sources. Another version is refused here, and an element out of order by Boost.

#include <boost/archive/xml_iarchive.hpp>
#include <boost/serialization/list.hpp>
#include <boost/serialization/map.hpp>
#include <boost/serialization/set.hpp>
#include <boost/serialization/string.hpp>
#include <boost/serialization/split_member.hpp>
#include <boost/serialization/version.hpp>
#include <fstream>
#include <iostream>
#include <memory>

using boost::serialization::make_nvp;

#define ITEM(name, field) ar & make_nvp(name, field)

/// Refuses another version of a class than the one that is declared below.
template<class A, class T> void same(A&, const T&, unsigned found) {
    const unsigned wanted = boost::serialization::version<T>::value;
    if (found != wanted)
        throw std::runtime_error(std::string(typeid(T).name()) + ": found version " + std::to_string(found) + ", expected " + std::to_string(wanted));
}

struct Key {
    double time = 0, value = 0, left = 0, right = 0;
    int kind = 0;
    bool operator<(const Key& other) const { return time < other.time; }
    template<class A> void serialize(A& ar, unsigned version) {
        same(ar, *this, version);
        ITEM("Time", time); ITEM("Value", value); ITEM("InterpolationMethod", kind);
        ITEM("LeftDerivative", left); ITEM("RightDerivative", right);
    }
};

struct Curve {
    std::set<Key> keys;
    template<class A> void serialize(A& ar, unsigned version) {
        same(ar, *this, version);
        ITEM("KeyFrameSet", keys);
    }
};

struct Value {
    std::string kind, text, expression;
    bool enabled = false, animated = false, master = false, ret = false;
    Curve curve;
    template<class A> void serialize(A& ar, unsigned version) {
        same(ar, *this, version);
        ITEM("Enabled", enabled); ITEM("HasAnimation", animated);
        if (animated) ITEM("Curve", curve);
        if (kind == "Bool") { bool v, d; ITEM("Value", v); ITEM("Default", d); text = std::to_string(v); }
        else if (kind == "Double") { double v, d; ITEM("Value", v); ITEM("Default", d); text = std::to_string(v); }
        else { int v, d; ITEM("Value", v); ITEM("Default", d); text = std::to_string(v); }
        ITEM("HasMaster", master);
        if (master) throw std::runtime_error("a master");
        ITEM("Expression", expression); ITEM("ExprHasRet", ret);
    }
};

struct Knob {
    std::string name, kind, label;
    int dimension = 0;
    bool secret = false, alias = false, user = false;
    std::vector<Value> values;
    template<class A> void serialize(A& ar, unsigned version) {
        same(ar, *this, version);
        ITEM("Name", name); ITEM("Type", kind); ITEM("Dimension", dimension); ITEM("Secret", secret); ITEM("MasterIsAlias", alias);
        values.resize(dimension);
        for (Value& value : values) { value.kind = kind; ITEM("item", value); }
        if (kind == "Choice") ITEM("ChoiceLabel", label);
        ITEM("UserKnob", user);
        if (user) throw std::runtime_error("a user's parameter");
    }
};

struct Item {
    std::string name, label, parent;
    bool active = false, locked = false;
    virtual ~Item() {}
    template<class A> void serialize(A& ar, unsigned version) {
        same(ar, *this, version);
        ITEM("Name", name); ITEM("Label", label); ITEM("Activated", active); ITEM("ParentLayer", parent); ITEM("Locked", locked);
    }
};

struct Drawable : Item {
    std::list<Knob> knobs;
    double colour[4];
    template<class A> void serialize(A& ar, unsigned version) {
        same(ar, *this, version);
        ITEM("RotoItemSerialization", boost::serialization::base_object<Item>(*this));
        int count; ITEM("NbItems", count);
        for (int i = 0; i < count; ++i) { knobs.emplace_back(); ITEM("Item", knobs.back()); }
        ITEM("OC.r", colour[0]); ITEM("OC.g", colour[1]); ITEM("OC.b", colour[2]); ITEM("OC.a", colour[3]);
    }
};

struct Point {
    double still[6];
    Curve curves[6];
    template<class A> void serialize(A& ar, unsigned version) {
        same(ar, *this, version);
        const char* names[] = {"X", "Y", "Left_X", "Left_Y", "Right_X", "Right_Y"};
        for (int i = 0; i < 6; ++i) {
            std::string animation = std::string(names[i]) + "_animation";
            ITEM(names[i], still[i]); ITEM(animation.c_str(), curves[i]);
        }
    }
};

struct Bezier : Drawable {
    std::vector<Point> points, feather;
    bool closed = false, open = false;
    template<class A> void serialize(A& ar, unsigned version) {
        same(ar, *this, version);
        ITEM("RotoDrawableItemSerialization", boost::serialization::base_object<Drawable>(*this));
        int count; ITEM("NumPoints", count);
        for (int i = 0; i < count; ++i) {
            points.emplace_back(); ITEM("CP", points.back());
            feather.emplace_back(); ITEM("FP", feather.back());
        }
        ITEM("Closed", closed); ITEM("OpenBezier", open);
    }
};

struct Layer : Item {
    std::list<Bezier> children;
    template<class A> void serialize(A& ar, unsigned version) {
        same(ar, *this, version);
        ITEM("RotoItemSerialization", boost::serialization::base_object<Item>(*this));
        int count; ITEM("NumChildren", count);
        for (int i = 0; i < count; ++i) {
            int type; ITEM("Type", type);
            if (type != 0) throw std::runtime_error("no curve");
            children.emplace_back(); ITEM("Item", children.back());
        }
    }
};

struct Context {
    Layer base;
    bool keying, ripple, link;
    std::list<std::string> selection;
    template<class A> void serialize(A& ar, unsigned version) {
        same(ar, *this, version);
        ITEM("BaseLayer", base); ITEM("AutoKeying", keying); ITEM("RippleEdit", ripple); ITEM("FeatherLink", link); ITEM("Selection", selection);
    }
};

struct Plane {
    std::string a, b;
    template<class A> void serialize(A& ar, unsigned version) {
        same(ar, *this, version);
        ITEM("Layer", a);
    }
};

struct Node {
    std::string label, name, plugin, module, master, parent, cache;
    unsigned moduleVersion; int major, minor, count;
    std::map<std::string, std::string> inputs;
    unsigned long long age; bool roto = false, tracker = false;
    Context context; std::list<Plane> planes;
    template<class A> void serialize(A& ar, unsigned version) {
        same(ar, *this, version);
        ITEM("Plugin_label", label); ITEM("Plugin_script_name", name); ITEM("Plugin_id", plugin); ITEM("PythonModule", module);
        ITEM("PythonModuleVersion", moduleVersion); ITEM("Plugin_major_version", major); ITEM("Plugin_minor_version", minor);
        ITEM("KnobsCount", count);
        if (count) throw std::runtime_error("parameters of the node");
        ITEM("Inputs_map", inputs); ITEM("KnobsAge", age); ITEM("MasterNode", master); ITEM("HasRotoContext", roto);
        if (roto) ITEM("RotoContext", context);
        ITEM("HasTrackerContext", tracker); ITEM("MultiInstanceParent", parent);
        for (const char* tag : {"UserPagesCount", "PagesCount", "Children"}) {
            ITEM(tag, count);
            if (count) throw std::runtime_error(tag);
        }
        ITEM("UserComponents", planes); ITEM("CacheID", cache);
    }
};

struct Nodes {
    std::list<Node> nodes;
    template<class A> void serialize(A& ar, unsigned version) {
        same(ar, *this, version);
        int count; ITEM("NodesCount", count);
        for (int i = 0; i < count; ++i) { nodes.emplace_back(); ITEM("item", nodes.back()); }
    }
};

struct Rectangle {
    int left, bottom, right, top;
    virtual ~Rectangle() {}
    template<class A> void serialize(A& ar, unsigned version) {
        same(ar, *this, version);
        ITEM("Left", left); ITEM("Bottom", bottom); ITEM("Right", right); ITEM("Top", top);
    }
};

struct Format : Rectangle {
    double aspect; std::string name;
    template<class A> void serialize(A& ar, unsigned version) {
        same(ar, *this, version);
        ITEM("RectI", boost::serialization::base_object<Rectangle>(*this)); ITEM("Pixel_aspect_ratio", aspect); ITEM("Name", name);
    }
};

struct Project {
    int number[3], bits, now; long long made;
    std::string branch, commit, os;
    Nodes nodes; std::list<Knob> knobs; std::list<Format> formats;
    template<class A> void serialize(A& ar, unsigned version) {
        same(ar, *this, version);
        ITEM("VersionMajor", number[0]); ITEM("VersionMinor", number[1]); ITEM("VersionRev", number[2]);
        ITEM("GitBranch", branch); ITEM("GitCommit", commit); ITEM("OS", os); ITEM("Bits", bits); ITEM("NodesCollection", nodes);
        int count; ITEM("ProjectKnobsCount", count);
        for (int i = 0; i < count; ++i) { knobs.emplace_back(); ITEM("item", knobs.back()); }
        ITEM("AdditionalFormats", formats); ITEM("Timeline_current_time", now); ITEM("CreationDate", made);
    }
};

BOOST_CLASS_VERSION(Project, 6)
BOOST_CLASS_VERSION(Nodes, 1)
BOOST_CLASS_VERSION(Node, 15)
BOOST_CLASS_VERSION(Context, 2)
BOOST_CLASS_VERSION(Layer, 2)
BOOST_CLASS_VERSION(Item, 2)
BOOST_CLASS_VERSION(Drawable, 4)
BOOST_CLASS_VERSION(Bezier, 4)
BOOST_CLASS_VERSION(Point, 4)
BOOST_CLASS_VERSION(Knob, 14)
BOOST_CLASS_VERSION(Value, 7)
BOOST_CLASS_VERSION(Plane, 2)
BOOST_CLASS_VERSION(Format, 3)

static void print(const char* what, const Knob& knob) {
    std::cout << what << ' ' << knob.name << ' ' << knob.label;
    for (const Value& value : knob.values) {
        std::cout << ' ' << value.text;
        for (const Key& key : value.curve.keys) std::cout << " @" << key.time << '=' << key.value << '/' << key.kind;
    }
    std::cout << '\n';
}

int main(int, char** words) {
    try {
        std::ifstream file(words[1]);
        boost::archive::xml_iarchive archive(file);
        bool background; Project project;
        archive >> make_nvp("Background_project", background) >> make_nvp("Project", project);
        std::cout << "background " << background << " now " << project.now << '\n';
        for (const Knob& knob : project.knobs) print("setting", knob);
        for (const Format& format : project.formats) std::cout << "format " << format.right << 'x' << format.top << ' ' << format.aspect << '\n';
        for (const Node& node : project.nodes.nodes) {
            std::cout << "node " << node.plugin << ' ' << node.context.base.name << ' ' << node.cache << '\n';
            for (const Bezier& bezier : node.context.base.children) {
                std::cout << "curve " << bezier.closed << ' ' << bezier.name << ' ' << bezier.label << '\n';
                for (const Knob& knob : bezier.knobs) print("parameter", knob);
                for (const auto* points : {&bezier.points, &bezier.feather})
                    for (const Point& point : *points) {
                        std::cout << (points == &bezier.points ? "point" : "feather");
                        for (const Curve& curve : point.curves) {
                            std::cout << " |";
                            for (const Key& key : curve.keys) std::cout << ' ' << key.time << '=' << key.value;
                        }
                        std::cout << '\n';
                    }
            }
        }
        return 0;
    } catch (const std::exception& error) {
        std::cerr << error.what() << '\n';
        return 1;
    }
}
