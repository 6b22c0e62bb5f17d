//! Sheets that are pulled, bent and turned.

use super::*;

/// A sheet of `columns` × `rows` squares, each cut in two.
fn sheet(columns: usize, rows: usize) -> Mesh {
    let vertices = (0..(columns + 1) * (rows + 1))
        .map(|k| Point::new((k % (columns + 1)) as f64, (k / (columns + 1)) as f64 + 0.1 * (k as f64).sin()))
        .collect();
    let at = |i: usize, j: usize| j * (columns + 1) + i;
    let triangles = (0..columns * rows)
        .flat_map(|k| {
            let (i, j) = (k % columns, k / columns);
            [[at(i, j), at(i + 1, j), at(i, j + 1)], [at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]]
        })
        .collect();
    Mesh::new(vertices, triangles).unwrap()
}

#[test]
fn a_rigid_move_of_the_handles_moves_the_mesh_rigidly() {
    let mesh = sheet(39, 19);
    assert_eq!(mesh.vertices().len(), 800);
    let handles = [0, 39, 410, 799];
    let turn = Point::from_angle(0.83);
    let moved = |p: &Point| turn.rotate(*p) + Point::new(12.0, -7.0);
    let places: Vec<Point> = handles.iter().map(|&h| moved(&mesh.vertices()[h])).collect();
    let found = deform(&mesh, &handles, &places).unwrap();
    for (v, p) in mesh.vertices().iter().zip(&found) {
        assert!(moved(v).distance(*p) < 1e-9);
    }
}

#[test]
fn a_kept_solver_and_a_single_call_agree() {
    let mesh = sheet(12, 4);
    let handles = [0, 12, 30, 64];
    let mut solver = Solver::new(mesh.clone(), &handles).unwrap();
    for frame in 0..4 {
        let sway = |h: usize| mesh.vertices()[h] + Point::new(0.0, 0.5 * frame as f64 * (h as f64).sin());
        let places: Vec<Point> = handles.iter().map(|&h| sway(h)).collect();
        let kept = solver.solve(&places).unwrap();
        assert_eq!(kept, deform(&mesh, &handles, &places).unwrap());
        assert!(handles.iter().zip(&places).all(|(&h, p)| kept[h] == *p));
    }
}

#[test]
fn a_bent_strip_keeps_its_area_better_than_the_first_step_alone() {
    let mesh = sheet(16, 2);
    let handles = [0, 17, 34, 16, 33, 50];
    let bend = |v: Point| if v.x < 8.0 { v } else { Point::new(8.0 - v.y, 8.0 + (v.x - 8.0) * 0.5) };
    let places: Vec<Point> = handles.iter().map(|&h| bend(mesh.vertices()[h])).collect();
    let mut solver = Solver::new(mesh.clone(), &handles).unwrap();
    let found = solver.solve(&places).unwrap();
    let worst = |placed: &[Point]| {
        let length = |p: &[Point], a: usize, b: usize| p[a].distance(p[b]);
        let edges = mesh.triangles().iter().flat_map(|t| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]);
        edges.map(|(a, b)| (length(placed, a, b) / length(mesh.vertices(), a, b)).ln().powi(2)).sum::<f64>()
    };
    assert!(worst(&found) < worst(&solver.first), "{} {}", worst(&found), worst(&solver.first));
}

#[test]
fn heavier_triangles_bend_less() {
    let mesh = sheet(10, 1);
    let stiff = |weight: f64| {
        let weights = (0..20).map(|t| if t < 10 { weight } else { 1.0 }).collect();
        let mesh = Mesh::with_rigidity(mesh.vertices.clone(), mesh.triangles.clone(), weights).unwrap();
        let handles = [0, 11, 10, 21];
        let mut places: Vec<Point> = handles.iter().map(|&h| mesh.vertices[h]).collect();
        places[2].y += 4.0;
        places[3].y += 4.0;
        let found = deform(&mesh, &handles, &places).unwrap();
        // How far the half that may be stiff strays from a similar copy of itself.
        let half: Vec<usize> = (0..5).chain(11..16).collect();
        let rest: Vec<Point> = half.iter().map(|&v| mesh.vertices[v]).collect();
        let now: Vec<Point> = half.iter().map(|&v| found[v]).collect();
        let fit = rototoon_base::geometry::similarity::Similarity::fit(&rest, &now);
        rest.iter().zip(&now).map(|(a, b)| fit.apply(*a).distance_squared(*b)).sum::<f64>()
    };
    assert!(stiff(100.0) < 0.5 * stiff(1.0));
}

#[test]
fn one_handle_and_handles_on_one_spot_shift_the_mesh() {
    let mesh = sheet(3, 3);
    let found = deform(&mesh, &[5], &[mesh.vertices()[5] + Point::new(2.0, 1.0)]).unwrap();
    assert!(mesh.vertices().iter().zip(&found).all(|(v, p)| (*v + Point::new(2.0, 1.0)).distance(*p) < 1e-12));
    let spot = vec![Point::new(1.0, 1.0); 2];
    let pulled = deform(&mesh, &[0, 15], &spot).unwrap();
    assert!(pulled.iter().all(|p| p.is_finite()));
}

#[test]
fn all_vertices_may_be_handles() {
    let mesh = sheet(1, 1);
    let places: Vec<Point> = (0..4).map(|k| Point::new(k as f64, -1.0)).collect();
    assert_eq!(deform(&mesh, &[0, 1, 2, 3], &places).unwrap(), places);
}

#[test]
fn what_is_wrong_is_named() {
    let v = |x: f64, y: f64| Point::new(x, y);
    let square = vec![v(0.0, 0.0), v(1.0, 0.0), v(0.0, 1.0), v(5.0, 5.0)];
    let error = |vertices: &[Point], triangles: &[[usize; 3]]| {
        Mesh::new(vertices.to_vec(), triangles.to_vec()).unwrap_err().to_string()
    };
    assert_eq!(error(&square, &[[0, 1, 7]]), "triangle 0: found vertex 7, expected 0 to 3");
    assert_eq!(error(&square, &[[0, 1, 2]]), "vertex 3: found in no triangle, expected in at least one");
    assert!(error(&square, &[[0, 1, 1]]).starts_with("triangle 0: found area 0, expected"));
    assert!(error(&[v(f64::NAN, 0.0)], &[]).starts_with("vertex 0: found"));
    assert!(Mesh::with_rigidity(square.clone(), vec![[0, 1, 2]], vec![-1.0]).is_err());
    let mesh = sheet(2, 2);
    assert_eq!(
        deform(&mesh, &[1, 1], &[v(0.0, 0.0); 2]).unwrap_err(),
        ArapError::Handle { handle: 1, found: 1, last: 8 }
    );
    assert!(matches!(deform(&mesh, &[99], &[v(0.0, 0.0)]).unwrap_err(), ArapError::Handle { found: 99, .. }));
    assert!(matches!(deform(&mesh, &[1], &[]).unwrap_err(), ArapError::Places { found: 0, expected: 1 }));
    assert!(matches!(deform(&mesh, &[], &[]).unwrap_err(), ArapError::Adrift { vertex: 0 }));
    let apart = Mesh::new(
        vec![v(0.0, 0.0), v(1.0, 0.0), v(0.0, 1.0), v(5.0, 0.0), v(6.0, 0.0), v(5.0, 1.0)],
        vec![[0, 1, 2], [3, 4, 5]],
    );
    assert!(matches!(
        deform(&apart.unwrap(), &[0, 1, 3], &[v(0.0, 0.0); 3]).unwrap_err(),
        ArapError::Adrift { vertex: 3 }
    ));
}
