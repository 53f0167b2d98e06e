//! A four-wide bounding volume hierarchy: built from obvhs' binary one, traversed conservatively.

use glam::Vec4;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

use super::ray::PreparedRay;
use crate::accel::AccelError;
use crate::math::{Vec3, gamma};

/// An axis-aligned box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    /// Lower corner.
    pub(super) min: Vec3,
    /// Upper corner.
    pub(super) max: Vec3,
}

impl Bounds {
    /// Contains nothing; no ray meets it.
    const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    fn half_area(self) -> f32 {
        let e = self.max - self.min;
        e.x * e.y + e.y * e.z + e.z * e.x
    }
}

/// Up to four children with their boxes; unused slots hold empty boxes.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug)]
struct Node {
    /// By axis, then lower and upper plane, then child.
    planes: [[Vec4; 2]; 3],
    /// A node's index, or a leaf's with `LEAF` set.
    children: [u32; 4],
}

/// Marks a child as a leaf.
const LEAF: u32 = 1 << 31;

/// A hierarchy whose leaves are numbers that mean something to whoever traverses it.
pub(super) struct Tree {
    nodes: Vec<Node>,
    /// As in `Node::children`.
    root: u32,
    /// Around everything.
    bounds: Bounds,
    /// Entries a traversal's stack may need.
    stack: usize,
    empty: bool,
}

/// A subtree put aside: where it begins and what it is.
#[derive(Clone, Copy, Default)]
struct Entry {
    near: f32,
    child: u32,
}

/// Stack entries that fit into the traversal's own frame; deeper trees allocate.
const SHORT_STACK: usize = 64;

/// `1 + 2γ₃`: makes the slab test conservative (Ize 2013, "Robust BVH Ray Traversal", JCGT 2(2), §4): the near
/// parameter may be too large and the far one too small by three roundings each.
const FAR_PAD: f32 = 1.0 + 2.0 * gamma(3);

/// By how much a sheared corner may be off in units of its distance from the origin: five roundings of 2⁻²⁴ (Woop
/// et al. 2013, §4), and three more for the rounding of the margin itself.
const SHEAR_ERROR: f32 = 8.0 * 0.5 * f32::EPSILON;

impl Tree {
    /// Builds the hierarchy over `count` primitives, of which those without bounds are left out, with at most
    /// `leaf_size` of them to a leaf. The second result lists each leaf's primitives; with a `leaf_size` of one the
    /// tree's leaves are the primitives' own numbers instead.
    ///
    /// # Errors
    /// When there are more primitives than indices.
    pub(super) fn build(
        what: &str,
        count: usize,
        leaf_size: usize,
        bounds_of: impl Fn(u32) -> Option<Bounds>,
    ) -> Result<(Self, Vec<Vec<u32>>), AccelError> {
        // obvhs numbers its up to 2n − 1 nodes in u32 and uses the top bit as a mark.
        if count >= (LEAF / 2) as usize {
            let message = format!(
                "accelerator `bvh`: the scene has {count} {what}, the limit is {}; split the scene or use fewer",
                LEAF / 2 - 1
            );
            return Err(AccelError { message });
        }
        let (ids, bounds): (Vec<u32>, Vec<Bounds>) =
            (0..count as u32).filter_map(|i| bounds_of(i).map(|b| (i, b))).unzip();
        if ids.is_empty() {
            let tree = Self { nodes: Vec::new(), root: LEAF, bounds: Bounds::EMPTY, stack: 0, empty: true };
            return Ok((tree, Vec::new()));
        }
        let boxes: Vec<Aabb> = bounds.iter().map(|b| Aabb::new(b.min, b.max)).collect();
        let mut binary = PlocBuilder::with_capacity(boxes.len()).build(
            PlocSearchDistance::Medium,
            &boxes,
            (0..boxes.len() as u32).collect(),
            SortPrecision::U64,
            2,
        );
        ReinsertionOptimizer::default().run(&mut binary, REINSERTION, None);
        Ok(Collapse::new(&binary, &bounds, &ids, leaf_size).run())
    }

    /// Whether there is nothing in it.
    pub(super) fn is_empty(&self) -> bool {
        self.empty
    }

    /// Visits the leaves whose boxes the ray may meet at a parameter in `[ray.tmin, tmax]`, roughly from near to far.
    /// `visit` may lower `tmax`, and returns whether to stop.
    #[inline]
    pub(super) fn traverse<const ANY: bool>(
        &self,
        ray: &PreparedRay,
        tmax: f32,
        visit: impl FnMut(u32, &mut f32) -> bool,
    ) {
        if self.empty {
            return;
        }
        if self.stack <= SHORT_STACK {
            self.traverse_with::<ANY>(&mut [Entry::default(); SHORT_STACK], ray, tmax, visit);
        } else {
            self.traverse_with::<ANY>(&mut vec![Entry::default(); self.stack], ray, tmax, visit);
        }
    }

    #[inline(always)]
    fn traverse_with<const ANY: bool>(
        &self,
        stack: &mut [Entry],
        ray: &PreparedRay,
        mut tmax: f32,
        mut visit: impl FnMut(u32, &mut f32) -> bool,
    ) {
        // The triangles as the sheared test sees them may stick out of their boxes by the shear's rounding: every
        // box is grown by that much, by moving the origin the other way. One ulp further covers the sum's rounding.
        let extent = (self.bounds.min - ray.o).abs().max((self.bounds.max - ray.o).abs());
        let margin = (extent + Vec3::splat(extent[ray.kz])) * SHEAR_ERROR;
        let ulp = ray.o.abs() * f32::EPSILON;
        let (up, down) = (ray.o + (margin + ulp), ray.o - (margin + ulp));
        let [sx, sy, sz] = ray.negative;
        // For each axis the origin to subtract from lower planes and from upper ones.
        let origin: [[Vec4; 2]; 3] = std::array::from_fn(|k| [Vec4::splat(up[k]), Vec4::splat(down[k])]);
        let [rx, ry, rz] = ray.reciprocal.to_array().map(Vec4::splat);
        let (near_x, far_x) = (origin[0][sx & 1], origin[0][sx & 1 ^ 1]);
        let (near_y, far_y) = (origin[1][sy & 1], origin[1][sy & 1 ^ 1]);
        let (near_z, far_z) = (origin[2][sz & 1], origin[2][sz & 1 ^ 1]);
        let tmin = Vec4::splat(ray.tmin);

        let mut depth = 0;
        let mut current = self.root;
        loop {
            if current & LEAF != 0 {
                if visit(current ^ LEAF, &mut tmax) {
                    return;
                }
            } else {
                let node = &self.nodes[current as usize];
                let [x, y, z] = &node.planes;
                let near = ((x[sx & 1] - near_x) * rx)
                    .max((y[sy & 1] - near_y) * ry)
                    .max(((z[sz & 1] - near_z) * rz).max(tmin));
                let far = ((x[sx & 1 ^ 1] - far_x) * rx)
                    .min((y[sy & 1 ^ 1] - far_y) * ry)
                    .min(((z[sz & 1 ^ 1] - far_z) * rz).min(Vec4::splat(tmax)))
                    * FAR_PAD;
                let mut mask = near.cmple(far).bitmask();
                if mask != 0 {
                    let first = mask.trailing_zeros() as usize & 3;
                    mask &= mask - 1;
                    current = node.children[first];
                    if mask == 0 {
                        continue;
                    }
                    let near = near.to_array();
                    let mut current_near = near[first];
                    let base = depth;
                    while mask != 0 {
                        let next = mask.trailing_zeros() as usize & 3;
                        mask &= mask - 1;
                        let mut entry = Entry { near: near[next], child: node.children[next] };
                        if entry.near < current_near {
                            (entry, current_near, current) =
                                (Entry { near: current_near, child: current }, entry.near, entry.child);
                        }
                        // Nearest on top. An any-hit query does not care.
                        let mut at = depth;
                        if !ANY {
                            while at > base && stack[at - 1].near < entry.near {
                                stack[at] = stack[at - 1];
                                at -= 1;
                            }
                        }
                        stack[at] = entry;
                        depth += 1;
                    }
                    continue;
                }
            }
            current = loop {
                if depth == 0 {
                    return;
                }
                depth -= 1;
                let entry = stack[depth];
                if entry.near <= tmax * FAR_PAD {
                    break entry.child;
                }
            };
        }
    }
}

/// Ratio of nodes that obvhs considers for reinsertion.
const REINSERTION: f32 = 0.2;

/// Cost of one more slot in a node, relative to the test of a block of primitives.
const SPLIT_COST: f32 = 0.3;

/// The conversion of a binary tree.
struct Collapse<'a> {
    binary: &'a Bvh2,
    ids: &'a [u32],
    leaf_size: usize,
    /// Per binary node: its exact box, taken from the primitives again, and how many there are below.
    summary: Vec<(Bounds, u32)>,
    /// Per binary node: whether all of it goes into one leaf.
    leaf: Vec<bool>,
    nodes: Vec<Node>,
    leaves: Vec<Vec<u32>>,
}

impl<'a> Collapse<'a> {
    fn new(binary: &'a Bvh2, bounds: &[Bounds], ids: &'a [u32], leaf_size: usize) -> Self {
        let mut summary = vec![(Bounds::EMPTY, 0); binary.nodes.len()];
        let mut leaf = vec![true; binary.nodes.len()];
        let mut cost = vec![0.0; binary.nodes.len()];
        // Parents before children, so that the reverse meets children first. No recursion: a tree over many equal
        // boxes may be as deep as it is large.
        let mut order = vec![0_u32];
        let mut next = 0;
        while let Some(&index) = order.get(next) {
            let node = &binary.nodes[index as usize];
            if !node.is_leaf() {
                order.extend([node.first_index, node.first_index + 1]);
            }
            next += 1;
        }
        for &index in order.iter().rev() {
            let node = &binary.nodes[index as usize];
            let first = node.first_index as usize;
            summary[index as usize] = if node.is_leaf() {
                let primitives = &binary.primitive_indices[first..first + node.prim_count as usize];
                let around = primitives.iter().fold(Bounds::EMPTY, |b, &p| b.union(bounds[p as usize]));
                cost[index as usize] = around.half_area();
                (around, node.prim_count)
            } else {
                let ((a, n), (b, m)) = (summary[first], summary[first + 1]);
                let (around, count) = (a.union(b), n + m);
                // A block costs the same however many of its lanes are in use.
                let together = around.half_area();
                let apart = cost[first] + cost[first + 1] + SPLIT_COST * together;
                leaf[index as usize] = count as usize <= leaf_size && together <= apart;
                cost[index as usize] = if leaf[index as usize] { together } else { apart };
                (around, count)
            };
        }
        Self { binary, ids, leaf_size, summary, leaf, nodes: Vec::new(), leaves: Vec::new() }
    }

    fn is_leaf(&self, index: u32) -> bool {
        self.leaf[index as usize]
    }

    fn run(mut self) -> (Tree, Vec<Vec<u32>>) {
        let bounds = self.summary[0].0;
        let root = if self.is_leaf(0) { self.leaf(0) } else { 0 };
        // Depth first, so that a node, its first child and their leaves lie close together in memory. Each entry is
        // a binary node, the depth of the wide node it becomes, and the slot that waits for its number.
        let mut pending = Vec::new();
        if root & LEAF == 0 {
            pending.push((0, 1, None));
        }
        let mut deepest = 0;
        while let Some((index, depth, parent)) = pending.pop() {
            let number = self.nodes.len();
            if let Some((parent, slot)) = parent {
                let node: &mut Node = &mut self.nodes[parent];
                node.children[slot] = number as u32;
            }
            deepest = deepest.max(depth);
            let mut slots = [(Bounds::EMPTY, LEAF); 4];
            let children = self.four_children(index);
            for (slot, &child) in children.iter().enumerate() {
                // An inner child's number is filled in when it gets one.
                let target = if self.is_leaf(child) { self.leaf(child) } else { 0 };
                slots[slot] = (self.summary[child as usize].0, target);
            }
            for (slot, &child) in children.iter().enumerate().rev() {
                if !self.is_leaf(child) {
                    pending.push((child, depth + 1, Some((number, slot))));
                }
            }
            let plane = |of: fn(&Bounds) -> Vec3, axis: usize| Vec4::from_array(slots.map(|s| of(&s.0)[axis]));
            self.nodes.push(Node {
                planes: std::array::from_fn(|axis| [plane(|b| b.min, axis), plane(|b| b.max, axis)]),
                children: slots.map(|s| s.1),
            });
        }
        let tree = Tree { nodes: self.nodes, root, bounds, stack: 3 * deepest, empty: false };
        (tree, self.leaves)
    }

    /// The binary nodes that become the children of a wide node: the largest is opened until there are four, the
    /// greedy minimum of the surface area heuristic.
    fn four_children(&self, index: u32) -> Vec<u32> {
        let first = self.binary.nodes[index as usize].first_index;
        let mut children = vec![first, first + 1];
        while children.len() < 4 {
            let area = |&i: &usize| self.summary[children[i] as usize].0.half_area();
            let inner = (0..children.len()).filter(|&i| !self.is_leaf(children[i]));
            let Some(open) = inner.max_by(|a, b| area(a).total_cmp(&area(b))) else { break };
            let first = self.binary.nodes[children[open] as usize].first_index;
            children[open] = first;
            children.insert(open + 1, first + 1);
        }
        children
    }

    /// Turns a small subtree into a leaf and returns its mark.
    fn leaf(&mut self, index: u32) -> u32 {
        let mut primitives = Vec::new();
        let mut pending = vec![index];
        while let Some(i) = pending.pop() {
            let node = &self.binary.nodes[i as usize];
            let first = node.first_index;
            if node.is_leaf() {
                let range = first as usize..(first + node.prim_count) as usize;
                primitives.extend(self.binary.primitive_indices[range].iter().map(|&p| self.ids[p as usize]));
            } else {
                pending.extend([first, first + 1]);
            }
        }
        if self.leaf_size == 1 {
            return LEAF | primitives[0];
        }
        self.leaves.push(primitives);
        LEAF | (self.leaves.len() - 1) as u32
    }
}

#[cfg(test)]
impl Tree {
    /// All of it as text, for comparisons.
    pub(super) fn dump(&self) -> String {
        format!("{:?} {:x} {:?} {}", self.nodes, self.root, self.bounds, self.stack)
    }
}
