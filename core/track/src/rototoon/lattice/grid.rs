//! A grid of squares of which some are taken. Their corners are numbered so that the equations of the corners have a
//! narrow band.

/// The taken squares of a grid are cells, and their corners are nodes.
#[derive(Clone, Debug)]
pub struct Numbered {
    /// Column and row of each node. Nodes are numbered line by line, along the shorter side of the grid.
    pub nodes: Vec<(usize, usize)>,
    /// The nodes of each cell: top left, top right, bottom left, bottom right.
    pub cells: Vec<[usize; 4]>,
    /// The cell of each square, row by row.
    pub cell_of: Vec<Option<usize>>,
    /// Largest difference of the numbers of two nodes of one cell.
    pub reach: usize,
}

impl Numbered {
    /// Numbers a grid of `columns` × `rows` squares. `taken` says which squares are cells, row by row.
    pub fn new(columns: usize, rows: usize, taken: &[bool]) -> Self {
        let mut numbered = Self { nodes: Vec::new(), cells: Vec::new(), cell_of: vec![None; taken.len()], reach: 0 };
        let node_of = numbered.number_nodes(columns, rows, taken);
        for (square, _) in taken.iter().enumerate().filter(|(_, taken)| **taken) {
            let corner = square / columns * (columns + 1) + square % columns;
            let cell = [0, 1, columns + 1, columns + 2].map(|next| node_of[corner + next]);
            let reach = cell.iter().max().unwrap_or(&0) - cell.iter().min().unwrap_or(&0);
            numbered.reach = numbered.reach.max(reach);
            numbered.cell_of[square] = Some(numbered.cells.len());
            numbered.cells.push(cell);
        }
        numbered
    }

    /// Numbers the corners of the cells. Returns the number of each corner of the grid, row by row.
    fn number_nodes(&mut self, columns: usize, rows: usize, taken: &[bool]) -> Vec<usize> {
        let is_taken = |c: usize, r: usize| c < columns && r < rows && taken[r * columns + c];
        let mut node_of = vec![usize::MAX; (columns + 1) * (rows + 1)];
        let wide = columns > rows;
        let (lines, across) = if wide { (columns, rows) } else { (rows, columns) };
        for line in 0..=lines {
            for place in 0..=across {
                let (c, r) = if wide { (line, place) } else { (place, line) };
                let (left, above) = (c.wrapping_sub(1), r.wrapping_sub(1));
                if is_taken(c, r) || is_taken(left, r) || is_taken(c, above) || is_taken(left, above) {
                    node_of[r * (columns + 1) + c] = self.nodes.len();
                    self.nodes.push((c, r));
                }
            }
        }
        node_of
    }
}
